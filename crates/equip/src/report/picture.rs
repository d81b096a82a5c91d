//! The pictures of a scene: error and energy defect against run time, error against gradients; the legend stands above.
//!
//! A method has the same colour, dashes and mark in every picture.

use super::contender::Contender;
use super::measure::{Curve, Point};
use crate::panel::{Axis, Panel};
use crate::svg::{Anchor, FAINT, INK, Mark, Svg};

/// Height of the panels, their distance from the left edge, and the room between them.
const SIDE: f64 = 360.0;
const LEFT: f64 = 86.0;
const BETWEEN: f64 = 100.0;
/// Width of an entry of the legend, and height of a row.
const ENTRY: f64 = 222.0;
const ROW: f64 = 24.0;
/// Radius of the marks.
const RADIUS: f64 = 2.8;
/// Errors from here on are not drawn.
const WRONG: f64 = 10.0;

/// How a curve is drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Look {
    pub(super) colour: String,
    pub(super) dashes: &'static str,
    pub(super) width: f64,
    pub(super) mark: Mark,
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
        mark: Mark::Triangle,
    };
    match contender {
        Contender::Equip(s) => Look {
            colour: shade(BLUES, *s),
            dashes: "none",
            width: 2.4,
            mark: Mark::Disc,
        },
        Contender::Swept(s) => Look {
            colour: shade(GREENS, *s),
            dashes: "2 3",
            width: 2.4,
            mark: Mark::Diamond,
        },
        Contender::Variable(_) => Look {
            colour: "#c2185b".into(),
            dashes: "none",
            width: 2.4,
            mark: Mark::Disc,
        },
        Contender::Gauss(s) => Look {
            colour: shade(ORANGES, *s),
            dashes: "7 4",
            width: 1.6,
            mark: Mark::Square,
        },
        Contender::Composition(scheme) => full(match scheme.order {
            2 => "#8c8c8c",
            8 => "#5f5f5f",
            _ => "#2b2b2b",
        }),
        Contender::Dop853 => full("#8e5bb5"),
    }
}

/// A point of two positive figures; the first one's repeats lie between `least` and `most`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) least: f64,
    pub(super) most: f64,
}

impl Spot {
    /// A point without spread.
    pub(super) fn exact(x: f64, y: f64) -> Self {
        let (least, most) = (x, x);
        Spot { x, y, least, most }
    }
}

/// A named line through points.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) name: String,
    pub(super) look: Look,
    /// For each panel its points.
    pub(super) points: Vec<Vec<Spot>>,
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
            let timed = |p: &Point, y: f64| {
                let (least, most) = p.spread();
                let x = p.median();
                Spot { x, y, least, most }
            };
            let work = |p: &Point| Spot::exact(p.outcome.gradients as f64, p.outcome.error);
            Line {
                name: curve.contender.name(),
                look: look(&curve.contender),
                points: vec![
                    drawn().map(|p| timed(p, p.outcome.error)).collect(),
                    drawn().map(|p| timed(p, p.outcome.energy)).collect(),
                    drawn().map(work).collect(),
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

/// Panels side by side with one legend above; a line through a mark is the spread of its repeats.
pub(super) fn draw(title: &str, labels: &[Labels], lines: &[Line]) -> String {
    // One panel alone may be wider.
    let wide = if labels.len() == 1 { 820.0 } else { 350.0 };
    let apart = wide + BETWEEN;
    let width = LEFT + apart * labels.len() as f64 - BETWEEN + 34.0;
    let columns = ((width - 24.0) / ENTRY) as usize;
    let rows = lines.len().div_ceil(columns);
    let top = 62.0 + ROW * rows as f64 + 14.0;
    let mut svg = Svg::new(width as u32, (top + SIDE + 62.0) as u32);
    svg.text((24.0, 34.0), 19, Anchor::Start, INK, title);
    for (i, line) in lines.iter().enumerate() {
        let (x, y) = (
            24.0 + ENTRY * (i % columns) as f64,
            62.0 + ROW * (i / columns) as f64,
        );
        let look = &line.look;
        let sample = [(x, y), (x + 34.0, y)].into_iter();
        svg.dashed(sample, &look.colour, look.width + 0.4, look.dashes);
        let middle = [(x + 17.0, y)].into_iter();
        svg.marks(middle, look.mark, RADIUS + 1.0, &look.colour);
        svg.text((x + 42.0, y + 5.0), 14, Anchor::Start, INK, &line.name);
    }
    for (k, (x, y)) in labels.iter().enumerate() {
        let shown = |line: &Line| -> Vec<Spot> {
            let real = |p: &&Spot| p.x.is_finite() && p.x > 0.0 && p.y.is_finite();
            let points = line.points.get(k).into_iter().flatten();
            points.filter(real).copied().collect()
        };
        let all: Vec<_> = lines.iter().flat_map(&shown).collect();
        let left = LEFT + apart * k as f64;
        if all.is_empty() {
            svg.text((left, top + 40.0), 14, Anchor::Start, FAINT, "no point");
            continue;
        }
        let panel = Panel {
            left,
            top,
            width: wide,
            height: SIDE,
            x: axis(all.iter().map(|p| p.x), x),
            y: axis(all.iter().map(|p| p.y), y),
        };
        panel.draw_axes(&mut svg);
        // What is zero stands on the lower edge.
        let at = |x: f64, p: &Spot| panel.at((x, p.y.max(1e-300)));
        for line in lines {
            let (look, points) = (&line.look, shown(line));
            for p in points.iter().filter(|p| p.most > p.least) {
                svg.line(at(p.least, p), at(p.most, p), &look.colour, 0.5);
            }
            let places = points.iter().map(|p| at(p.x, p));
            svg.dashed(places.clone(), &look.colour, look.width, look.dashes);
            svg.marks(places, look.mark, RADIUS, &look.colour);
        }
    }
    svg.finish()
}

/// A little more than the positive values.
fn axis(values: impl Iterator<Item = f64>, label: &str) -> Axis {
    let positive = values.filter(|x| *x > 0.0);
    let (low, high) = positive.fold((f64::INFINITY, 0.0), |(l, h): (f64, f64), x| {
        (l.min(x), h.max(x))
    });
    if high > 0.0 {
        Axis::powers(low, high, label)
    } else {
        Axis::powers(1e-17, 1e-15, label)
    }
}
