//! [`Results`]: a scene with all that was measured on it.

use super::accuracy::{Time, time_to};
use super::contender::Outcome;
use super::measure::Curve;
use crate::draw::figure::Figure;
use crate::limits::LEVELS;

/// A scene with all that was measured on it.
#[derive(Debug)]
pub(crate) struct Results {
    pub(crate) name: &'static str,
    pub(crate) precision: &'static str,
    pub(crate) title: String,
    pub(crate) source: String,
    pub(crate) invariants: Vec<&'static str>,
    pub(crate) targets: &'static [f64],
    pub(crate) curves: Vec<Curve>,
    pub(crate) figure: Figure,
}

impl Results {
    pub(super) fn id(&self) -> String {
        format!("{}-{}", self.name, self.precision)
    }
}

/// The least round-off level of H that a run of EQUIP found: that of Gauss is the same.
pub(super) fn round_off(curves: &[Curve]) -> Option<f64> {
    let points = curves.iter().flat_map(|curve| &curve.points);
    let levels = points.filter_map(|point| point.outcome.round_off);
    levels.min_by(f64::total_cmp)
}

/// Whether a run conserved the energy to round-off, where the level is known.
pub(super) fn is_conserved(outcome: &Outcome, round_off: Option<f64>) -> bool {
    round_off.is_none_or(|round_off| outcome.energy <= LEVELS * round_off)
}

/// The times of a method to each target.
pub(super) fn times(curve: &Curve, targets: &[f64]) -> Vec<Time> {
    let points: Vec<_> = curve
        .points
        .iter()
        .map(|p| (p.outcome.error, p.median()))
        .collect();
    targets
        .iter()
        .map(|&target| time_to(target, &points))
        .collect()
}
