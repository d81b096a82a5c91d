//! The statements: what the paper says, what was measured, whether it holds.

use super::convergence::{Convergence, Member, STEPS};
use super::orbit::Orbit;
use super::residual::{self, Residual};
use serde::Serialize;

/// Orders are measured to within this.
const ORDER: f64 = 0.15;
/// The rate of α₀(h) is measured to within this.
const RATE: f64 = 0.05;
/// Round-off of the energy and the angular momentum after two periods in double-double (measured: 4e-31), and
/// after 200 000 steps in double (3e-15).
const WIDE: f64 = 1e-28;
const DOUBLE: f64 = 1e-13;

#[derive(Debug, Serialize)]
pub(super) struct Statement {
    pub(super) statement: String,
    pub(super) stated: String,
    pub(super) measured: String,
    pub(super) holds: bool,
}

impl Statement {
    pub(super) fn word(&self) -> &'static str {
        if self.holds { "yes" } else { "NO" }
    }
}

pub(super) fn statements(
    convergence: &[Convergence],
    residual: &Residual,
    orbits: &[Orbit],
) -> Vec<Statement> {
    let mut all = Vec::new();
    for row in convergence {
        let s = row.stages as f64;
        let (what, order, in_s) = match row.method {
            Member::Gauss => ("order of the Gauss method", 2.0 * s, "2s"),
            Member::Fixed => ("order at fixed α = 0.02", 2.0 * s - 2.0, "2s − 2"),
            Member::Solved => ("order with g(α, h) = 0", 2.0 * s, "2s"),
        };
        all.push(Statement {
            statement: format!("{what}, s = {}", row.stages),
            stated: format!("{in_s} = {order}"),
            measured: format!("{:.2}", row.order()),
            holds: (row.order() - order).abs() <= ORDER,
        });
    }
    for curve in &residual.curves {
        let steps = curve.steps;
        all.push(Statement {
            statement: format!(
                "g(α, h) vanishes, s = {}, {steps} steps a period",
                residual::STAGES
            ),
            stated: "at an α₀(h) near 0".into(),
            measured: format!("α₀ = {:.3e}", curve.root),
            holds: curve.left <= WIDE && curve.root.abs() < 0.05,
        });
    }
    let solved =
        |row: &&Convergence| row.method == Member::Solved && row.stages == residual::STAGES;
    let largest = convergence.iter().find(solved).map(|row| row.alphas);
    let largest = largest.map_or(f64::NAN, |[.., one, other]| (one / other).log2());
    for (what, rate) in [
        ("from the pericentre", residual.rate()),
        ("largest of two periods", largest),
    ] {
        all.push(Statement {
            statement: format!("α₀(h) = const · h², s = {}, {what}", residual::STAGES),
            stated: "rate 2".into(),
            measured: format!("{rate:.3}"),
            holds: (rate - 2.0).abs() <= RATE,
        });
    }
    for (method, what) in [(Member::Fixed, "fixed α"), (Member::Solved, "g(α, h) = 0")] {
        let rows = convergence.iter().filter(|row| row.method == method);
        let most = rows.map(|row| row.momentum).fold(0.0, f64::max);
        all.push(Statement {
            statement: format!("angular momentum, {what}, up to {} steps", 2 * STEPS[2]),
            stated: "conserved".into(),
            measured: format!("|ΔL| ≤ {most:.1e}"),
            holds: most <= WIDE,
        });
    }
    for orbit in orbits.iter().filter(|o| o.method == Member::Solved) {
        let gauss = orbits
            .iter()
            .find(|o| o.method == Member::Gauss && o.stages == orbit.stages);
        let (error, energy) = gauss.map_or((f64::NAN, f64::NAN), |o| {
            (o.figures.last_period, o.figures.energy)
        });
        let (s, orbit) = (orbit.stages, &orbit.figures);
        all.push(Statement {
            statement: format!("energy over 1000 periods, s = {s}"),
            stated: "conserved".into(),
            measured: format!("|ΔH| ≤ {:.1e} (Gauss {energy:.1e})", orbit.energy),
            holds: orbit.energy <= DOUBLE,
        });
        all.push(Statement {
            statement: format!("angular momentum over 1000 periods, s = {s}"),
            stated: "conserved".into(),
            measured: format!("|ΔL| ≤ {:.1e}", orbit.momentum),
            holds: orbit.momentum <= DOUBLE,
        });
        all.push(Statement {
            statement: format!("largest error over period 1000, s = {s}"),
            stated: "below that of Gauss".into(),
            measured: format!("{:.2e} (Gauss {error:.2e})", orbit.last_period),
            holds: orbit.last_period < error,
        });
    }
    all
}
