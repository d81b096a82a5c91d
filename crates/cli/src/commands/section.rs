//! `equip section`: the Poincaré section of Hénon and Heiles, drawn.
//!
//! The plane q1 = 0, crossed with p1 > 0, at one energy: (q2, p2) of every crossing, one colour for each
//! orbit. Orbits start on the axes q2 = 0 and p2 = 0 of the section, evenly. The crossings are events,
//! located on dense output to round-off.

use crate::args::{SectionArgs, number};
use crate::draw::figure::{Figure, Look};
use crate::draw::panel::{Axis, Panel};
use crate::draw::svg::{COLOURS, EQUIP, FAINT, GAUSS};
use crate::fault::Fault;
use crate::run::progress::steps_of;
use crate::write::outputs::Drawing;
use equip_integrate::{Equip, Event, Record};
use equip_scenes::Scene;
use std::fmt::Write as _;
use std::io::{Write as _, stdout};

/// The scene whose section is drawn.
const SCENE: &str = "henon-heiles";
/// Colours of the orbits, by turns.
const TURNS: [&str; 6] = [EQUIP, GAUSS, COLOURS[0], COLOURS[1], COLOURS[2], COLOURS[3]];
/// Points of the boundary above the axis p2 = 0.
const BOUNDARY: usize = 400;

/// Crossings (q2, p2) of one orbit.
type Crossings = Vec<(f64, f64)>;

pub(crate) fn section(args: &SectionArgs) -> Result<(), Fault> {
    let scene = equip_scenes::find(&args.scene)?;
    if scene.name != SCENE {
        return Err(Fault::option("SCENE", scene.name, SCENE));
    }
    let energy: f64 = number("--energy", &args.energy)?;
    let tolerance: f64 = number("--tolerance", &args.tolerance)?;
    let end: f64 = number("--until", &args.until)?;
    if !end.is_finite() {
        return Err(Fault::option("--until", &args.until, "finite"));
    }
    let mut drawing = Drawing::new(&args.plot, args.csv.as_deref())?;
    let mut orbits: Vec<Crossings> = Vec::new();
    let (mut worst, mut steps) = (0.0f64, 0);
    let starts = starts(energy, args.orbits as usize);
    let bar = steps_of("orbits", starts.len());
    for (q2, p2) in starts {
        let (made, energy_error, count) = orbit(scene, args, (q2, p2), (tolerance, end))?;
        drawing.create()?;
        orbits.push(made);
        worst = worst.max(energy_error);
        steps += count;
        bar.inc(1);
    }
    bar.finish_and_clear();
    drawing.write(&draw(&orbits, args, energy), || table(&orbits))?;
    let count: usize = orbits.iter().map(Vec::len).sum();
    let mut out = stdout().lock();
    writeln!(out, "{:<24}{count} of {} orbits", "crossings", orbits.len())?;
    writeln!(out, "{:<24}{steps}", "steps")?;
    writeln!(out, "{:<24}max {worst:.1e}", "energy error")?;
    writeln!(out, "{:<24}{}", "plot written to", args.plot.display())?;
    Ok(())
}

/// The crossings of one orbit, the largest energy error and the number of steps.
fn orbit(
    scene: &'static Scene,
    args: &SectionArgs,
    (q2, p2): (f64, f64),
    (tolerance, end): (f64, f64),
) -> Result<(Crossings, f64, u64), Fault> {
    let (q2, p2) = (format!("{q2:e}"), format!("{p2:e}"));
    let values = [("energy", args.energy.as_str()), ("q2", &q2), ("p2", &p2)];
    let instance = scene.instance(&values)?;
    let (q, p) = instance.initial::<f64>();
    let crossing = Event::new("q1 = 0", |_, q: &[f64], _: &[f64]| q[0]);
    // p1 > 0 is where q1 rises with time.
    let crossing = if end < 0.0 {
        crossing.falling()
    } else {
        crossing.rising()
    };
    let run = Equip::stages(args.stages)
        .tolerance(tolerance)
        .record(Record::Ends)
        .event(crossing)
        .integrate(instance.hamiltonian(), &q, &p, 0.0..=end)
        .map_err(Fault::undrawn)?;
    let start = std::iter::once((q[1], p[1]));
    let crossings = run.events().iter().map(|event| (event.q[1], event.p[1]));
    let certificate = run.certificate();
    let energy_error = certificate.energy.as_ref().map_or(0.0, |energy| energy.max);
    Ok((
        start.chain(crossings).collect(),
        energy_error,
        certificate.counts.steps,
    ))
}

/// What is left of 2 E for p1² + p2² at q1 = 0.
fn room(energy: f64, q2: f64) -> f64 {
    2.0 * energy - q2 * q2 + 2.0 / 3.0 * q2.powi(3)
}

/// The bounds of q2 on either side of 0, by bisection of `room`; q2 = 1 is where orbits escape.
fn bounds(energy: f64) -> (f64, f64) {
    let bound = |side: f64| {
        let (mut inside, mut outside) = (0.0, side);
        for _ in 0..60 {
            let middle = (inside + outside) / 2.0;
            if room(energy, middle) > 0.0 {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    };
    (bound(-1.0), bound(1.0))
}

/// Starts on both axes of the section, within its boundary.
fn starts(energy: f64, orbits: usize) -> Vec<(f64, f64)> {
    let ((low, high), top) = (bounds(energy), (2.0 * energy).sqrt());
    let on_q = orbits.div_ceil(2);
    let share = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let along_q = (0..on_q).map(|i| (low + (high - low) * share(i, on_q), 0.0));
    let on_p = orbits - on_q;
    let along_p = (0..on_p).map(|i| (0.0, top * (2.0 * share(i, on_p) - 1.0)));
    along_q.chain(along_p).collect()
}

/// The curve p1 = 0 that bounds the section: nothing of this energy is outside.
fn boundary(energy: f64) -> Vec<(f64, f64)> {
    let (low, high) = bounds(energy);
    let above = (0..=BOUNDARY).map(|k| {
        // Points are dense at both ends, where the curve is steep.
        let angle = std::f64::consts::PI * k as f64 / BOUNDARY as f64;
        let q2 = (low + high) / 2.0 - (high - low) / 2.0 * angle.cos();
        (q2, room(energy, q2).max(0.0).sqrt())
    });
    let above: Vec<_> = above.collect();
    let below = above.iter().rev().map(|&(q2, p2)| (q2, -p2));
    above.iter().copied().chain(below).collect()
}

fn draw(orbits: &[Crossings], args: &SectionArgs, energy: f64) -> String {
    let boundary = boundary(energy);
    let mut panel = Panel::sized(
        (760.0, 700.0),
        Axis::around(boundary.iter().map(|p| p.0), "q\u{2082}"),
        Axis::around(boundary.iter().map(|p| p.1), "p\u{2082}"),
    );
    panel.same_units();
    let mut svg = panel.svg("");
    let edge = boundary.iter().map(|&point| panel.at(point));
    svg.polyline(edge, FAINT, 1.4);
    for (orbit, colour) in orbits.iter().zip(TURNS.iter().cycle()) {
        svg.dots(orbit.iter().map(|&point| panel.at(point)), colour, 2.0);
    }
    let figure = Figure {
        title: format!(
            "H\u{e9}non\u{2013}Heiles, E = {}: Poincar\u{e9} section q\u{2081} = 0, p\u{2081} > 0",
            args.energy
        ),
        facts: format!(
            "EQUIP, {} stages, tolerance {}: {} crossings of {} orbits to t = {}, orbits in alternating colours",
            args.stages,
            args.tolerance,
            orbits.iter().map(Vec::len).sum::<usize>(),
            orbits.len(),
            args.until
        ),
        legend: vec![(
            "p\u{2081} = 0, boundary of the energy surface".into(),
            Look::line(FAINT),
        )],
        panels: vec![svg],
    };
    figure.file(&args.plot)
}

fn table(orbits: &[Crossings]) -> String {
    let mut text = "orbit,q2,p2\n".to_owned();
    for (number, orbit) in (1..).zip(orbits) {
        for (q2, p2) in orbit {
            // Writing to a String does not fail.
            let _ = writeln!(text, "{number},{q2:e},{p2:e}");
        }
    }
    text
}
