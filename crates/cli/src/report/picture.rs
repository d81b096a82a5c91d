//! The pictures of a scene: error and energy defect against run time; error against gradients, or the defect
//! of an invariant against run time.
//!
//! A method has the same colour, dashes and mark in every picture.

use super::contender::Contender;
use super::measure::{Curve, Point};
use crate::draw::chart::{Line, Look, Spot, draw};
use crate::draw::svg::Mark;

/// Errors from here on are not drawn.
const WRONG: f64 = 10.0;

/// Colours of the stages, from light to dark with more of them; distinct also where red and green look alike.
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
    const ORANGES: [&str; 5] = ["#f7c98b", "#f0a13c", "#d97a12", "#a9560a", "#6b3304"];
    match contender {
        Contender::Equip(s) => Look {
            colour: shade(BLUES, *s),
            dashes: "none",
            width: 2.4,
            mark: Mark::Disc,
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
    }
}

/// The picture of a scene.
pub(super) fn scene(title: &str, curves: &[Curve], invariant: Option<&str>) -> String {
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
            let kept =
                |p: &Point| timed(p, p.outcome.invariants.first().copied().unwrap_or(f64::NAN));
            let third = match invariant {
                Some(_) => drawn().map(kept).collect(),
                None => drawn().map(work).collect(),
            };
            Line {
                name: curve.contender.name(),
                look: look(&curve.contender),
                points: vec![
                    drawn().map(|p| timed(p, p.outcome.error)).collect(),
                    drawn().map(|p| timed(p, p.outcome.energy)).collect(),
                    third,
                ],
            }
        })
        .collect();
    let time = "CPU time / ms";
    let named = invariant.map(|name| format!("largest defect of {name}"));
    let third = match &named {
        Some(defect) => (time, defect.as_str()),
        None => ("gradients of H", "error of (q, p) at the end"),
    };
    let labels = [
        (time, "error of (q, p) at the end"),
        (time, "largest energy defect"),
        third,
    ];
    draw(title, &labels, &lines)
}
