//! `equip scenes`: the catalogue, and one page of it.

use crate::args::ScenesArgs;
use crate::fault::Fault;
use crate::text::significant;
use crate::text::wrapped;
use equip_scenes::{Parameter, Scene};
use std::io::{Write, stdout};

/// The width of the longest label of [`describe`], and two blanks.
const LABELS: usize = 22;

pub(crate) fn scenes(args: &ScenesArgs) -> Result<(), Fault> {
    match &args.name {
        Some(name) => describe(equip_scenes::find(name)?, &mut stdout().lock()),
        None => list(&mut stdout().lock()),
    }
}

fn list(out: &mut impl Write) -> Result<(), Fault> {
    let width = |text: fn(&Scene) -> &'static str| {
        equip_scenes::all()
            .iter()
            .map(|s| text(s).chars().count())
            .max()
            .unwrap_or(0)
    };
    let (names, titles) = (width(|s| s.name), width(|s| s.title));
    writeln!(
        out,
        "{:<names$}  {:<titles$}  {:>3}  parameters",
        "scene", "title", "m"
    )?;
    for scene in equip_scenes::all() {
        let m = scene.instance(&[])?.hamiltonian().degrees_of_freedom();
        let parameters = scene
            .parameters
            .iter()
            .map(|p| format!("{}={}", p.name, p.default));
        let parameters = parameters.collect::<Vec<_>>().join(" ");
        let label = format!("{:<names$}  {:<titles$}  {m:>3}  ", scene.name, scene.title);
        writeln!(
            out,
            "{}",
            wrapped(&label, label.chars().count(), &parameters)
        )?;
    }
    writeln!(
        out,
        "\nm: degrees of freedom with these parameters\n\
         `equip scenes NAME` describes a scene, `equip run NAME` integrates it"
    )?;
    Ok(())
}

fn describe(scene: &'static Scene, out: &mut impl Write) -> Result<(), Fault> {
    let instance = scene.instance(&[])?;
    let width = (scene.name.chars().count() + 2).max(LABELS);
    let mut line = |label: &str, text: &str| writeln!(out, "{}", wrapped(label, width, text));
    line(scene.name, scene.title)?;
    line("", scene.formula)?;
    let m = instance.hamiltonian().degrees_of_freedom();
    line("degrees of freedom", &m.to_string())?;
    line("source", scene.source)?;
    line("invariants besides H", scene.invariants)?;
    line("solution", scene.solution)?;
    line("difficulty", scene.hard)?;
    if !scene.units.is_empty() {
        line("units", scene.units)?;
    }
    let period = significant(instance.period(), 7);
    match scene.period {
        "" => line(
            "time scale",
            &format!("{period}, the unit of time; the motion has no period"),
        )?,
        of => line("period", &format!("{period}, {of}"))?,
    }
    let (step, end) = (instance.suggested_step(), instance.suggested_end());
    line(
        "suggested",
        &format!(
            "step {} (order 8), until t = {}",
            significant(step, 5),
            significant(end, 5)
        ),
    )?;
    let mut label = "parameters";
    for Parameter {
        name,
        meaning,
        default,
        range,
        integer,
    } in scene.parameters
    {
        let whole = if *integer { "whole number " } else { "" };
        line(
            label,
            &format!("--{name} {default}  {meaning}, {whole}in {range}"),
        )?;
        label = "";
    }
    Ok(())
}
