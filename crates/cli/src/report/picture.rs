//! The picture of a scene: error and energy error against run time, and error against gradients.
//!
//! A method has its colour, a number of stages its mark, and step control its dashes.

use super::contender::Contender;
use super::measure::{Curve, Point};
use super::results::is_conserved;
use crate::draw::chart::{Line, Plot, Spot, chart};
use crate::draw::figure::{Figure, Look};
use crate::draw::svg::{EQUIP, GAUSS, Mark};

/// Errors from here on are not drawn.
const WRONG: f64 = 10.0;

/// The look of a method.
fn look(contender: &Contender) -> Look {
    Look {
        colour: if contender.is_equip { EQUIP } else { GAUSS },
        dashes: if contender.adapts { "7 4" } else { "none" },
        width: 1.6,
        mark: Some(match contender.stages {
            0..=3 => Mark::Wedge,
            4..=5 => Mark::Triangle,
            6..=7 => Mark::Square,
            8..=9 => Mark::Disc,
            _ => Mark::Diamond,
        }),
    }
}

/// The picture of a scene whose round-off level of H is `floor`.
pub(super) fn scene(title: &str, curves: &[Curve], round_off: Option<f64>) -> Figure {
    let starts = curves.iter().flat_map(|curve| &curve.points);
    let start = starts.map(|p| p.outcome.start).find(|start| *start > 0.0);
    let (unit, energy) = match start {
        Some(start) => (start, "largest |ΔH/H₀|"),
        None => (1.0, "largest |ΔH|"),
    };
    let lines: Vec<Line> = curves
        .iter()
        .map(|curve| {
            let points = || {
                // Where nothing is right there is nothing to compare.
                let drawn = curve.points.iter().filter(|p| p.outcome.error < WRONG);
                drawn.map(|p| (p, !is_conserved(&p.outcome, round_off)))
            };
            let timed = |(p, is_hollow): (&Point, bool), y: f64| {
                let ((least, most), x) = (p.spread(), p.median());
                Spot {
                    x,
                    y,
                    least,
                    most,
                    is_hollow,
                }
            };
            let work = |(p, is_hollow): (&Point, bool)| Spot {
                is_hollow,
                ..Spot::exact(p.outcome.gradients as f64, p.outcome.error)
            };
            Line {
                name: curve.contender.name(),
                look: look(&curve.contender),
                points: vec![
                    points().map(|p| timed(p, p.0.outcome.error)).collect(),
                    points()
                        .map(|p| timed(p, p.0.outcome.energy / unit))
                        .collect(),
                    points().map(work).collect(),
                ],
            }
        })
        .collect();
    let (time, error) = ("CPU time / ms", "error of (q, p)");
    let plots = [
        Plot::new("Error at the end", time, error),
        Plot {
            round_off: round_off.map(|round_off| round_off / unit),
            ..Plot::new("Energy error", time, energy)
        },
        Plot::new("Work", "number of ∇H", error),
    ];
    let facts = "Hollow marks: the energy is not conserved to round-off. Colour: method; mark: number of stages; dashes: step size control.";
    chart(title, facts, &plots, &lines)
}
