//! What `benches/peers` measured, read from its JSON file to be joined to the page.

use crate::draw::chart::{Line, Plot, Spot, chart};
use crate::draw::figure::{Figure, Look};
use crate::draw::page::{cell, table};
use crate::draw::svg::{COLOURS, EQUIP, FAINT, GAUSS, INK, Mark, escape};
use crate::fault::Fault;
use crate::text::three_digits;
use crate::write::lock::ordinary;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Errors from here on are not drawn.
const WRONG: f64 = 10.0;
/// Bytes of a text at most: the name of a scene is part of the name of a file.
const LONGEST: usize = 200;

/// The file of the peers.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct Peers {
    cpu: String,
    /// Programs and their versions.
    #[serde(default)]
    versions: BTreeMap<String, Option<String>>,
    pub(super) scenes: Vec<Scene>,
}

/// A scene of the comparison.
#[derive(Debug, Deserialize, Serialize)]
pub(super) struct Scene {
    pub(super) scene: String,
    title: String,
    targets: Vec<f64>,
    programs: Vec<Program>,
    curves: Vec<Curve>,
    at_tolerance: Option<AtTolerance>,
}

/// All programs at one tolerance.
#[derive(Debug, Deserialize, Serialize)]
struct AtTolerance {
    tolerance: f64,
    rows: Vec<Row>,
}

/// A program at a tolerance.
#[derive(Debug, Deserialize, Serialize)]
struct Row {
    program: String,
    method: String,
    error: Option<f64>,
    milliseconds: f64,
    least: f64,
    most: f64,
}

/// A program with its quickest way to each target.
#[derive(Debug, Deserialize, Serialize)]
struct Program {
    program: String,
    reached: Vec<Option<Reached>>,
}

/// A target reached.
#[derive(Debug, Deserialize, Serialize)]
struct Reached {
    method: String,
    milliseconds: f64,
    least: f64,
    most: f64,
    ratio_to_quickest_peer: Option<f64>,
}

#[derive(Debug, Deserialize, Serialize)]
struct Curve {
    program: String,
    points: Vec<Point>,
}

#[derive(Debug, Deserialize, Serialize)]
struct Point {
    error: Option<f64>,
    milliseconds: Option<f64>,
}

/// Reads the file.
///
/// # Errors
/// If it cannot be read, or is none of the peers' files.
pub(super) fn read(path: &Path) -> Result<Peers, Fault> {
    let wrong = |e: String| {
        let value = format!("{} ({e})", path.display());
        Fault::option(
            "--peers",
            value,
            "a file peers.json written by benches/peers",
        )
    };
    ordinary("--peers", path)?;
    let text = std::fs::read_to_string(path).map_err(|e| wrong(e.to_string()))?;
    let peers: Peers = serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
    match serde_json::to_value(&peers).is_ok_and(|all| is_printable(&all)) {
        true => Ok(peers),
        false => Err(wrong(format!(
            "a text of more than {LONGEST} bytes, or with control characters"
        ))),
    }
}

/// Whether all texts are fit for pictures, tables and names of files.
fn is_printable(value: &Value) -> bool {
    let fits = |text: &str| text.len() <= LONGEST && !text.contains(char::is_control);
    match value {
        Value::String(text) => fits(text),
        Value::Array(all) => all.iter().all(is_printable),
        Value::Object(all) => all
            .iter()
            .all(|(name, value)| fits(name) && is_printable(value)),
        Value::Null | Value::Bool(_) | Value::Number(_) => true,
    }
}

impl Scene {
    /// Error against time: of each program the settings that no other of its settings beats in both.
    pub(super) fn figure(&self) -> Figure {
        let mut ours_first: Vec<&Program> = self.programs.iter().collect();
        ours_first.sort_by_key(|p| !is_ours(&p.program));
        let lines: Vec<Line> = ours_first
            .iter()
            .map(|program| {
                let curves = self.curves.iter().filter(|c| c.program == program.program);
                let points = curves.flat_map(|c| &c.points);
                let points = points
                    .filter_map(|p| Some((p.milliseconds?, p.error?)))
                    .collect();
                let spots = front(points).into_iter();
                Line {
                    name: program.program.clone(),
                    look: look(&program.program),
                    points: vec![spots.map(|(x, y)| Spot::exact(x, y)).collect()],
                }
            })
            .collect();
        let plot = Plot::new("", "CPU time / ms", "error of (q, p) at the end");
        chart(&self.title, "", &[plot], &lines)
    }
}

/// The part of the page on other programs.
pub(super) fn section(peers: &Peers) -> String {
    let mut text = format!(
        "<h2 id=\"peers\">Compared with other programs</h2>\n<p>CPU milliseconds on {}; docs/compare.md has the rules. In brackets: the time \
         of EQUIP divided by that of the fastest other program. The tooltip of a figure has the smallest and the largest time of the rounds.</p>\n\
         <p class=\"note\">{}</p>\n",
        escape(&peers.cpu),
        escape(&versions(peers))
    );
    for scene in &peers.scenes {
        text += &scene.figure().html();
        text += &against(scene);
        if let Some(at) = &scene.at_tolerance {
            text += &format!(
                "<h3>All at tolerance {:.0e}</h3>\n{}",
                at.tolerance,
                at_tolerance(at)
            );
        }
    }
    text
}

fn versions(peers: &Peers) -> String {
    let all = peers.versions.iter();
    let known =
        all.filter_map(|(program, version)| Some(format!("{program} {}", version.as_ref()?)));
    known.collect::<Vec<_>>().join(", ")
}

fn against(scene: &Scene) -> String {
    let text = |program: &Program, reached: &Option<Reached>| match reached {
        None => "–".into(),
        Some(r) => {
            let ours = is_ours(&program.program);
            let ratio = r.ratio_to_quickest_peer.filter(|_| ours);
            let ratio = ratio.map_or(String::new(), |x| format!(" ({x:.2})"));
            let [least, milliseconds, most] = [r.least, r.milliseconds, r.most].map(three_digits);
            format!(
                "<span title=\"{least} to {most}\">{milliseconds}{ratio}</span> <small>{}</small>",
                escape(&r.method)
            )
        }
    };
    let rows = scene.programs.iter().map(|program| {
        let mut cells = vec![cell("program", escape(&program.program))];
        let columns = scene.targets.iter().zip(&program.reached);
        cells.extend(
            columns.map(|(t, reached)| (format!("{t:.0e}").into(), text(program, reached))),
        );
        cells
    });
    table("numbers", rows)
}

fn at_tolerance(at: &AtTolerance) -> String {
    let row = |row: &Row| {
        vec![
            cell("program", escape(&row.program)),
            cell("method", escape(&row.method)),
            cell("ms", three_digits(row.milliseconds)),
            cell("least", three_digits(row.least)),
            cell("most", three_digits(row.most)),
            cell(
                "error",
                row.error.map_or("–".into(), |e| format!("{e:.1e}")),
            ),
        ]
    };
    table("numbers", at.rows.iter().map(row))
}

/// Whether a program is this library.
fn is_ours(program: &str) -> bool {
    program.starts_with("equip")
}

/// The look of a program, the same in every picture: ours in blue, dashed with step control.
fn look(program: &str) -> Look {
    let (colour, mark) = match program {
        p if p.starts_with("equip closure") => (EQUIP, Mark::Disc),
        p if p.starts_with("equip by hand") => (EQUIP, Mark::Diamond),
        p if is_ours(p) => (EQUIP, Mark::Wedge),
        "heyoka" => (GAUSS, Mark::Triangle),
        "composition" => (INK, Mark::Square),
        "rebound" => (COLOURS[3], Mark::Triangle),
        "ode_solvers" => (COLOURS[0], Mark::Square),
        "differential-equations" => (COLOURS[0], Mark::Triangle),
        "diffsol" => (FAINT, Mark::Diamond),
        "scipy" => (COLOURS[1], Mark::Square),
        _ => (COLOURS[5], Mark::Wedge),
    };
    Look {
        colour,
        dashes: match is_ours(program) && program.ends_with("variable") {
            true => "7 4",
            false => "none",
        },
        width: if is_ours(program) { 2.2 } else { 1.6 },
        mark: Some(mark),
    }
}

/// The points that no other point beats in both time and error, by time; those far from any use left out.
fn front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.retain(|p| p.1 < WRONG);
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = f64::INFINITY;
    points.retain(|p| {
        let better = p.1 < best;
        best = best.min(p.1);
        better
    });
    points
}

#[cfg(test)]
mod tests {
    use super::front;

    #[test]
    fn only_what_is_not_beaten_is_drawn() {
        let points = vec![(3.0, 1e-3), (1.0, 1e-1), (2.0, 5e-1), (4.0, 1e-2)];
        assert_eq!(front(points), [(1.0, 1e-1), (3.0, 1e-3)]);
    }
}
