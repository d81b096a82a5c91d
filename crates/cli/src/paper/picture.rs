//! The pictures of the page.

use super::convergence::{Convergence, Member, STEPS};
use super::orbit::Orbit;
use super::residual::Residual;
use crate::draw::chart::{Line, Plot, Spot, chart};
use crate::draw::figure::{Figure, Look};
use crate::draw::panel::{Axis, Panel};
use crate::draw::svg::{COLOURS, EQUIP, FAINT, GAUSS, INK, Mark, Svg};

/// Colour by method, mark by stages.
fn look(method: Member, stages: usize) -> Look {
    let (colour, dashes) = match method {
        Member::Gauss => (GAUSS, "none"),
        Member::Fixed => (FAINT, "2 3"),
        Member::Solved => (EQUIP, "none"),
    };
    let mark = match stages {
        2 => Mark::Triangle,
        3 => Mark::Square,
        _ => Mark::Disc,
    };
    Look {
        colour,
        dashes,
        width: 1.8,
        mark: Some(mark),
    }
}

fn name(method: Member, stages: usize) -> String {
    let method = match method {
        Member::Gauss => "Gauss",
        Member::Fixed => "α = 0.02",
        Member::Solved => "EQUIP",
    };
    format!("{method}, s = {stages}")
}

/// Errors against steps.
pub(super) fn convergence(rows: &[Convergence]) -> Figure {
    let rows = rows.iter();
    let lines: Vec<Line> = rows
        .map(|row| Line {
            name: name(row.method, row.stages),
            look: look(row.method, row.stages),
            points: vec![
                (STEPS.iter().zip(row.errors))
                    .map(|(&steps, error)| Spot::exact(f64::from(steps), error))
                    .collect(),
            ],
        })
        .collect();
    let plot = Plot::new(
        "Two periods, in double-double",
        "steps per period",
        "error of (q, p)",
    );
    chart("Error after two periods", "", &[plot], &lines)
}

/// Energy errors over 1000 periods; H₀ = −1/2.
pub(super) fn energy(orbits: &[Orbit]) -> Figure {
    let spots = |orbit: &Orbit| -> Vec<Spot> {
        let each = orbit.figures.energies.iter().enumerate();
        // On a logarithmic axis, about as many marks in every decade.
        let part = |n: usize| (8.0 * (n as f64).log10()).floor() as i64;
        let each = each.filter(|(k, _)| *k == 0 || part(k + 1) > part(*k));
        each.map(|(k, &energy)| Spot::exact((k + 1) as f64, 2.0 * energy))
            .collect()
    };
    let lines: Vec<Line> = orbits
        .iter()
        .map(|orbit| Line {
            name: name(orbit.method, orbit.stages),
            look: look(orbit.method, orbit.stages),
            points: vec![spots(orbit)],
        })
        .collect();
    let plot = Plot::new("Largest of each period", "period", "|ΔH/H₀|");
    chart("Energy error over 1000 periods", "", &[plot], &lines)
}

/// g(α, h)/h³ over α, and α₀ over h.
pub(super) fn residual(residual: &Residual, rows: &[Convergence]) -> Figure {
    let curves = &residual.curves;
    let colours = [EQUIP, COLOURS[3], INK];
    let lines = curves.iter().zip(colours);
    let legend =
        lines.map(|(c, colour)| (format!("{} steps a period", c.steps), Look::line(colour)));
    let mut figure = roots(residual, rows);
    let mut all: Vec<_> = legend.collect();
    all.append(&mut figure.legend);
    Figure {
        title: "Energy error of a step, s = 2".into(),
        facts:
            "Left: from the pericentre, divided by h\u{b3}, with a dot at its zero \u{3b1}\u{2080}."
                .into(),
        legend: all,
        panels: [vec![slopes(residual, colours)], figure.panels].concat(),
    }
}

fn slopes(residual: &Residual, colours: [&'static str; 3]) -> Svg {
    let curves = &residual.curves;
    let scaled = |h: f64, g: f64| g / h.powi(3);
    let all = curves
        .iter()
        .flat_map(|c| c.points.iter().map(|&(_, g)| scaled(c.h, g)));
    let panel = Panel::new(
        Axis::between(-1.0, 1.0, "10\u{b3} \u{3b1}"),
        Axis::around(all, "g(\u{3b1}, h)/h\u{b3}"),
    );
    let mut svg = panel.svg("Energy error over \u{3b1}");
    svg.line(panel.at((-1.0, 0.0)), panel.at((1.0, 0.0)), INK, 1.0);
    for (curve, colour) in curves.iter().zip(colours) {
        let points = curve.points.iter();
        let points = points.map(|&(alpha, g)| panel.at((1e3 * alpha, scaled(curve.h, g))));
        svg.polyline(points, colour, 2.0);
        svg.dot(panel.at((1e3 * curve.root, 0.0)), 4.5, colour);
    }
    svg
}

/// α₀ over h.
fn roots(residual: &Residual, rows: &[Convergence]) -> Figure {
    let curves = &residual.curves;
    let is_it = |row: &&Convergence| row.method == Member::Solved && row.stages == residual.stages;
    let largest = rows.iter().find(is_it).map(|row| row.alphas);
    let at = |alphas: [f64; 3]| {
        let pairs = curves.iter().zip(alphas);
        pairs.map(|(c, alpha)| Spot::exact(c.h, alpha)).collect()
    };
    let roots = curves.iter().map(|c| Spot::exact(c.h, c.root.abs()));
    let line = |name: &str, stages: usize, points: Vec<Spot>| Line {
        name: name.into(),
        look: Look {
            colour: INK,
            ..look(Member::Solved, stages)
        },
        points: vec![points],
    };
    let lines = [
        line("|\u{3b1}\u{2080}| from the pericentre", 2, roots.collect()),
        line(
            "largest |\u{3b1}\u{2080}| of two periods",
            4,
            largest.map_or(Vec::new(), at),
        ),
    ];
    let plot = Plot::new(
        "Zero \u{3b1}\u{2080}(h) of the energy error",
        "h",
        "|\u{3b1}\u{2080}|",
    );
    chart("", "", &[plot], &lines)
}
