//! What `benches/peers` measured, read from its JSON file to be joined to the page.

use super::picture::{Line, Look, draw};
use crate::fault::Fault;
use serde::Deserialize;
use std::path::Path;

/// The file of the peers.
#[derive(Debug, Deserialize)]
pub(super) struct Peers {
    pub(super) cpu: String,
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
        const COLOURS: [&str; 9] = [
            "#2f7fb8", "#06305c", "#62a9d8", "#c0392b", "#3f8f5f", "#a03c8c", "#d97a12", "#8c8c8c",
            "#6b3304",
        ];
        let mut ours_first: Vec<&Program> = self.programs.iter().collect();
        ours_first.sort_by_key(|p| !p.program.starts_with("equip"));
        let lines: Vec<Line> = ours_first
            .iter()
            .enumerate()
            .map(|(i, program)| {
                let curves = self.curves.iter().filter(|c| c.program == program.program);
                let points = curves.flat_map(|c| &c.points);
                let points = points
                    .filter_map(|p| Some((p.milliseconds?, p.error?)))
                    .collect();
                Line {
                    name: program.program.clone(),
                    look: Look {
                        colour: COLOURS[i % COLOURS.len()].into(),
                        dashes: "none",
                        width: 2.0,
                    },
                    points: vec![front(points)],
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

/// The points that no other point beats in both time and error, by time.
fn front(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
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
