//! [`Results`]: a scene with all that was measured on it.

use super::accuracy::{Time, time_to};
use super::measure::Curve;

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
    pub(crate) svg: String,
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
