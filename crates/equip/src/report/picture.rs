//! The pictures of a scene: error and energy defect against run time, error against gradients; the legend stands above.
//!
//! A method has the same colour, dashes and mark in every picture.

use super::contender::Contender;
use super::measure::Curve;
use crate::panel::{Axis, Panel};
use crate::svg::{Anchor, FAINT, INK, Svg};

const WIDTH: u32 = 1380;
const SIDE: f64 = 330.0;
const PANEL: f64 = 350.0;
const LEFT: f64 = 86.0;
const APART: f64 = 454.0;
/// Width of an entry of the legend, entries in a row, and height of a row.
const ENTRY: f64 = 222.0;
const COLUMNS: usize = 6;
const ROW: f64 = 24.0;
/// Errors from here on are not drawn.
const WRONG: f64 = 10.0;

/// How a curve is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Look {
    pub(super) colour: String,
    pub(super) dashes: &'static str,
    pub(super) width: f64,
}

/// Colours of the stages, from light to dark with more of them; told apart also by those who do not see red and green apart.
fn shade(family: [&'static str; 5], stages: usize) -> String {
    let index = match stages {
        0..=3 => 0,
        4..=5 => 1,
        6..=7 => 2,
        8..=9 => 3,
        _ => 4,
    };
    family[index].into()
}

/// The look of a method.
pub(super) fn look(contender: &Contender) -> Look {
    const BLUES: [&str; 5] = ["#9ecae8", "#62a9d8", "#2f7fb8", "#125a8f", "#06305c"];
    const GREENS: [&str; 5] = ["#b5dfc4", "#7cc79b", "#3fa66f", "#1d7d4a", "#0b4f2c"];
    const ORANGES: [&str; 5] = ["#f7c98b", "#f0a13c", "#d97a12", "#a9560a", "#6b3304"];
    let full = |colour: &str| Look {
        colour: colour.into(),
        dashes: "none",
        width: 1.8,
    };
    match contender {
        Contender::Equip(s) => Look {
            colour: shade(BLUES, *s),
            dashes: "none",
            width: 2.4,
        },
        Contender::Swept(s) => Look {
            colour: shade(GREENS, *s),
            dashes: "2 3",
            width: 2.4,
        },
        Contender::Gauss(s) => Look {
            colour: shade(ORANGES, *s),
            dashes: "7 4",
            width: 1.6,
        },
        Contender::Composition(scheme) => full(match scheme.order {
            2 => "#8c8c8c",
            8 => "#5f5f5f",
            _ => "#2b2b2b",
        }),
        Contender::Dop853 => full("#a03c8c"),
    }
}

/// A named line through points of two positive figures.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) name: String,
    pub(super) look: Look,
    /// For each panel its points.
    pub(super) points: Vec<Vec<(f64, f64)>>,
}

/// What the axes of a panel are.
pub(super) type Labels = (&'static str, &'static str);

/// The picture of a scene.
pub(super) fn scene(title: &str, curves: &[Curve]) -> String {
    let lines: Vec<Line> = curves
        .iter()
        .map(|curve| {
            // Where nothing is right there is nothing to compare.
            let drawn = || curve.points.iter().filter(|p| p.outcome.error < WRONG);
            let of = |y: fn(&super::measure::Point) -> (f64, f64)| drawn().map(y).collect();
            Line {
                name: curve.contender.name(),
                look: look(&curve.contender),
                points: vec![
                    of(|p| (p.median(), p.outcome.error)),
                    of(|p| (p.median(), p.outcome.energy)),
                    of(|p| (p.outcome.gradients as f64, p.outcome.error)),
                ],
            }
        })
        .collect();
    let labels = [
        ("CPU time / ms", "error of (q, p) at the end"),
        ("CPU time / ms", "largest energy defect"),
        ("gradients of H", "error of (q, p) at the end"),
    ];
    draw(title, &labels, &lines)
}

/// Panels side by side with one legend.
pub(super) fn draw(title: &str, labels: &[Labels], lines: &[Line]) -> String {
    let rows = lines.len().div_ceil(COLUMNS);
    let top = 62.0 + ROW * rows as f64 + 14.0;
    let mut svg = Svg::new(WIDTH, (top + SIDE + 62.0) as u32);
    svg.text((24.0, 34.0), 19, Anchor::Start, INK, title);
    for (i, line) in lines.iter().enumerate() {
        let (x, y) = (
            24.0 + ENTRY * (i % COLUMNS) as f64,
            62.0 + ROW * (i / COLUMNS) as f64,
        );
        let sample = [(x, y), (x + 34.0, y)];
        svg.dashed(
            sample.into_iter(),
            &line.look.colour,
            line.look.width + 0.6,
            line.look.dashes,
        );
        svg.dot((x + 17.0, y), 3.4, &line.look.colour);
        svg.text((x + 42.0, y + 5.0), 14, Anchor::Start, INK, &line.name);
    }
    for (k, (x, y)) in labels.iter().enumerate() {
        let shown = |line: &Line| -> Vec<(f64, f64)> {
            let real = |p: &&(f64, f64)| p.0.is_finite() && p.0 > 0.0 && p.1.is_finite();
            line.points
                .get(k)
                .into_iter()
                .flatten()
                .filter(real)
                .copied()
                .collect()
        };
        let all: Vec<_> = lines.iter().flat_map(&shown).collect();
        let left = LEFT + APART * k as f64;
        if all.is_empty() {
            svg.text((left, top + 40.0), 14, Anchor::Start, FAINT, "no point");
            continue;
        }
        let panel = Panel {
            left,
            top,
            width: PANEL,
            height: SIDE,
            x: axis(all.iter().map(|p| p.0), x),
            y: axis(all.iter().map(|p| p.1), y),
        };
        panel.draw_axes(&mut svg);
        for line in lines {
            let points = shown(line);
            // What is zero stands on the lower edge.
            let at = points.iter().map(|&(x, y)| panel.at((x, y.max(1e-300))));
            svg.dashed(
                at.clone(),
                &line.look.colour,
                line.look.width,
                line.look.dashes,
            );
            svg.dots(at, &line.look.colour, 6.0);
        }
    }
    svg.finish()
}

/// Whole decades around the positive values.
fn axis(values: impl Iterator<Item = f64>, label: &str) -> Axis {
    let positive = values.filter(|x| *x > 0.0);
    let (low, high) = positive.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), x| {
        (l.min(x), h.max(x))
    });
    if high > 0.0 {
        Axis::decades(low, high, label)
    } else {
        Axis::decades(1e-17, 1e-15, label)
    }
}
