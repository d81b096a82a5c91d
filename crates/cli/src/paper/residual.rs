//! g(α, h) = H(y1(α, h)) − H(y0) of one step from the pericentre, two stages, in double-double; and where it
//! vanishes.

use super::convergence::STEPS;
use crate::fault::Fault;
use equip_integrate::{Method, Record};
use equip_scalar::{Constant, DoubleDouble, Float};
use equip_scenes::Instance;
use serde::Serialize;

/// Stages of the steps.
pub(super) const STAGES: usize = 2;
/// Points of a curve.
const POINTS: i64 = 41;
/// Iterations of the secant method; it converges in six.
const ITERATIONS: usize = 30;

/// g over α for some h.
#[derive(Debug, Serialize)]
pub(super) struct Residual {
    pub(super) stages: usize,
    pub(super) curves: Vec<Curve>,
}

#[derive(Debug, Serialize)]
pub(super) struct Curve {
    /// Steps per period.
    pub(super) steps: u32,
    pub(super) h: f64,
    /// (α, g).
    pub(super) points: Vec<(f64, f64)>,
    /// Where g vanishes, and |g| there.
    pub(super) root: f64,
    pub(super) left: f64,
}

impl Residual {
    /// Rate with which the root goes to zero with h, from the last two step sizes.
    pub(super) fn rate(&self) -> f64 {
        match &self.curves[..] {
            [.., one, other] => (one.root / other.root).log2(),
            _ => f64::NAN,
        }
    }
}

pub(super) fn measure(instance: &Instance) -> Result<Residual, Fault> {
    let curves = STEPS.into_iter().map(|steps| curve(instance, steps));
    Ok(Residual {
        stages: STAGES,
        curves: curves.collect::<Result<_, _>>()?,
    })
}

fn curve(instance: &Instance, steps: u32) -> Result<Curve, Fault> {
    let h = instance.period::<DoubleDouble>() / DoubleDouble::int(steps.into());
    let g = |alpha: DoubleDouble| g(instance, h, alpha);
    // By secants, from α = 0.
    let (mut before, mut alpha) = (DoubleDouble::int(0), DoubleDouble::ratio(1, 1000));
    let (mut at_before, mut at) = (g(before)?, g(alpha)?);
    for _ in 0..ITERATIONS {
        let next = alpha - at * (alpha - before) / (at - at_before);
        if !next.to_f64().is_finite() {
            break;
        }
        (before, at_before) = (alpha, at);
        (alpha, at) = (next, g(next)?);
    }
    let points = (0..POINTS).map(|k| {
        let alpha = DoubleDouble::ratio(k - POINTS / 2, 1000 * (POINTS / 2));
        Ok((alpha.to_f64(), g(alpha)?.to_f64()))
    });
    Ok(Curve {
        steps,
        h: h.to_f64(),
        points: points.collect::<Result<_, Fault>>()?,
        root: alpha.to_f64(),
        left: at.abs().to_f64(),
    })
}

/// The energy error of one step.
fn g(instance: &Instance, h: DoubleDouble, alpha: DoubleDouble) -> Result<DoubleDouble, Fault> {
    let (q, p) = instance.initial::<DoubleDouble>();
    let method = Method::fixed_alpha(STAGES, Constant::from_expansion(alpha.expansion()));
    let run = (method.step(h).record(Record::Ends))
        .integrate(instance.hamiltonian(), &q, &p, DoubleDouble::int(0)..=h)
        .map_err(|failure| Fault::start(failure.error))?;
    let mut evaluator = instance.hamiltonian().evaluator::<DoubleDouble>();
    let (_, q_end, p_end) = run.last();
    let end = evaluator.value(&[q_end, p_end].concat());
    Ok(end - evaluator.value(&[q, p].concat()))
}
