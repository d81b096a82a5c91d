//! The pictures of the page.

use super::convergence::{Convergence, Member, STEPS};
use super::orbit::Orbit;
use super::residual::Residual;
use crate::draw::chart::{Line, Look, Spot, draw};
use crate::draw::panel::{Axis, Panel};
use crate::draw::svg::{Anchor, INK, Mark, Svg};

const BLUES: [&str; 3] = ["#62a9d8", "#2f7fb8", "#06305c"];
const ORANGES: [&str; 3] = ["#f0a13c", "#d97a12", "#6b3304"];
const GREYS: [&str; 3] = ["#a8a8a8", "#7a7a7a", "#444444"];

fn look(method: Member, stages: usize) -> Look {
    let shade = stages.clamp(2, 4) - 2;
    let (colour, dashes, mark) = match method {
        Member::Gauss => (ORANGES[shade], "7 4", Mark::Square),
        Member::Fixed => (GREYS[shade], "2 3", Mark::Triangle),
        Member::Solved => (BLUES[shade], "none", Mark::Disc),
    };
    Look {
        colour: colour.into(),
        dashes,
        width: 2.0,
        mark,
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
pub(super) fn convergence(rows: &[Convergence]) -> String {
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
    draw(
        "Error after two periods",
        &[("steps per period", "error")],
        &lines,
    )
}

/// Energy errors over 1000 periods; half of ε where there is none.
pub(super) fn energy(orbits: &[Orbit]) -> String {
    let spots = |orbit: &Orbit| -> Vec<Spot> {
        let each = orbit.energies.iter().enumerate();
        // On a logarithmic axis, as many after 100 periods as before.
        let each = each.filter(|(k, _)| (k + 1) % (k / 20 + 1) == 0);
        each.map(|(k, &energy)| Spot::exact((k + 1) as f64, energy.max(f64::EPSILON / 2.0)))
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
    draw(
        "Largest |H − H₀| of a period",
        &[("period", "|H − H₀|")],
        &lines,
    )
}

const WIDTH: f64 = 820.0;
const HEIGHT: f64 = 360.0;
const LEFT: f64 = 110.0;
const TOP: f64 = 92.0;

/// g(α, h)/h³ over α.
pub(super) fn residual(residual: &Residual) -> String {
    let curves = &residual.curves;
    let scaled = |h: f64, g: f64| g / h.powi(3);
    let all = curves
        .iter()
        .flat_map(|c| c.points.iter().map(|&(_, g)| scaled(c.h, g)));
    let panel = Panel {
        left: LEFT,
        top: TOP,
        width: WIDTH,
        height: HEIGHT,
        x: Axis::between(-1e-3, 1e-3, "α"),
        y: Axis::around(all, "g(α, h)/h³"),
    };
    let mut svg = Svg::new((LEFT + WIDTH + 34.0) as u32, (TOP + HEIGHT + 62.0) as u32);
    let title = "Energy error of one step from the pericentre, s = 2; a dot where it vanishes";
    svg.text((24.0, 34.0), 19, Anchor::Start, INK, title);
    panel.draw_axes(&mut svg);
    svg.line(panel.at((-1e-3, 0.0)), panel.at((1e-3, 0.0)), INK, 1.0);
    for (k, curve) in curves.iter().enumerate() {
        let colour = BLUES[k % BLUES.len()];
        let x = 24.0 + 222.0 * k as f64;
        svg.line((x, 62.0), (x + 34.0, 62.0), colour, 2.4);
        let label = format!("{} steps a period", curve.steps);
        svg.text((x + 42.0, 67.0), 14, Anchor::Start, INK, &label);
        let points = curve.points.iter();
        let points = points.map(|&(alpha, g)| panel.at((alpha, scaled(curve.h, g))));
        svg.polyline(points, colour, 2.0);
        svg.dot(panel.at((curve.root, 0.0)), 4.5, colour);
    }
    svg.finish()
}

/// α₀ over h.
pub(super) fn roots(residual: &Residual, rows: &[Convergence]) -> String {
    let curves = &residual.curves;
    let is_it = |row: &&Convergence| row.method == Member::Solved && row.stages == residual.stages;
    let largest = rows.iter().find(is_it).map(|row| row.alphas);
    let at = |alphas: [f64; 3]| {
        let pairs = curves.iter().zip(alphas);
        pairs.map(|(c, alpha)| Spot::exact(c.h, alpha)).collect()
    };
    let roots = curves.iter().map(|c| Spot::exact(c.h, c.root.abs()));
    let line = |name: &str, shade: usize, points: Vec<Spot>| Line {
        name: name.into(),
        look: look(Member::Solved, shade),
        points: vec![points],
    };
    draw(
        "α₀(h), where the energy error of a step vanishes, s = 2",
        &[("h", "|α₀|")],
        &[
            line("from the pericentre", 2, roots.collect()),
            line("largest of two periods", 4, largest.map_or(Vec::new(), at)),
        ],
    )
}
