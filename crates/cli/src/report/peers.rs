//! What `benches/peers` measured, read from its JSON file to be joined to the page.

use crate::draw::chart::{Line, Look, Spot, draw};
use crate::draw::svg::Mark;
use crate::fault::Fault;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Errors from here on are not drawn.
const WRONG: f64 = 10.0;

/// The file of the peers.
#[derive(Debug, Deserialize)]
pub(super) struct Peers {
    pub(super) cpu: String,
    /// Programs and their versions.
    #[serde(default)]
    pub(super) versions: BTreeMap<String, Option<String>>,
    pub(super) scenes: Vec<Scene>,
}

/// A scene of the comparison.
#[derive(Debug, Deserialize)]
pub(super) struct Scene {
    pub(super) scene: String,
    pub(super) title: String,
    pub(super) targets: Vec<f64>,
    pub(super) programs: Vec<Program>,
    curves: Vec<Curve>,
    pub(super) at_tolerance: Option<AtTolerance>,
}

/// All programs at one tolerance.
#[derive(Debug, Deserialize)]
pub(super) struct AtTolerance {
    pub(super) tolerance: f64,
    pub(super) rows: Vec<Row>,
}

/// A program at a tolerance.
#[derive(Debug, Deserialize)]
pub(super) struct Row {
    pub(super) program: String,
    pub(super) method: String,
    pub(super) error: Option<f64>,
    pub(super) milliseconds: f64,
    pub(super) least: f64,
    pub(super) most: f64,
}

/// A program with its quickest way to each target.
#[derive(Debug, Deserialize)]
pub(super) struct Program {
    pub(super) program: String,
    pub(super) reached: Vec<Option<Reached>>,
}

/// A target reached.
#[derive(Debug, Deserialize)]
pub(super) struct Reached {
    pub(super) method: String,
    pub(super) milliseconds: f64,
    pub(super) least: f64,
    pub(super) most: f64,
    pub(super) ratio_to_quickest_peer: Option<f64>,
}

#[derive(Debug, Deserialize)]
struct Curve {
    program: String,
    points: Vec<Point>,
}

#[derive(Debug, Deserialize)]
struct Point {
    error: Option<f64>,
    milliseconds: Option<f64>,
}

/// Reads the file.
///
/// # Errors
/// If it cannot be read, or is none of the peers' files.
pub(super) fn read(path: &Path) -> Result<Peers, Fault> {
    let wrong = |e: String| Fault::Option {
        option: "--peers",
        value: format!("{} ({e})", path.display()),
        expected: "a file peers.json written by benches/peers",
    };
    let text = std::fs::read_to_string(path).map_err(|e| wrong(e.to_string()))?;
    serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))
}

impl Scene {
    /// Error against time: of each program the settings that no other of its settings beats in both.
    pub(super) fn picture(&self) -> String {
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
        draw(
            &self.title,
            &[("CPU time / ms", "error of (q, p) at the end")],
            &lines,
        )
    }
}

/// Whether a program is this library.
pub(super) fn is_ours(program: &str) -> bool {
    program.starts_with("equip")
}

/// The look of a program, the same in every picture: ours in blues, dashed with variable steps.
fn look(program: &str) -> Look {
    let colour = match program {
        p if p.starts_with("equip closure") => "#2f7fb8",
        p if p.starts_with("equip by hand") => "#06305c",
        p if is_ours(p) => "#7db7de",
        "heyoka" => "#c0392b",
        "composition" => "#2b2b2b",
        "rebound" => "#d97a12",
        "ode_solvers" => "#3f8f5f",
        "differential-equations" => "#8fc9a3",
        "diffsol" => "#9a9a9a",
        "scipy" => "#a03c8c",
        _ => "#6b3304",
    };
    let variable = is_ours(program) && program.ends_with("variable");
    Look {
        colour: colour.into(),
        dashes: if variable { "7 4" } else { "none" },
        width: if is_ours(program) { 2.4 } else { 1.8 },
        mark: match (is_ours(program), variable) {
            (true, false) => Mark::Disc,
            (true, true) => Mark::Diamond,
            (false, _) => Mark::Triangle,
        },
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
