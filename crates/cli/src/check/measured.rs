//! [`Measured`]: the figures of a row.

use super::leg::{Ended, Kept};

/// All figures of a row, as doubles.
#[derive(Debug, Clone, Default)]
pub(crate) struct Measured {
    pub(crate) steps: u64,
    /// Steps made, those that were split counted in parts.
    pub(crate) parts: u64,
    /// Steps by outcome, words and count; those that did not occur are left out.
    pub(crate) outcomes: Vec<(&'static str, u64)>,
    pub(crate) uncorrected: u64,
    pub(crate) energy: f64,
    pub(crate) levels: Option<f64>,
    pub(crate) independent_levels: Option<f64>,
    pub(crate) invariants: Vec<Kept>,
    pub(crate) ended: Option<Ended>,
    pub(crate) impatient: bool,
    pub(crate) error: Option<f64>,
    /// Error of Gauss from a start that is changed by one unit in the last place: what round-off does to the
    /// trajectory.
    pub(crate) noise: Option<f64>,
    pub(crate) gauss_error: Option<f64>,
    pub(crate) gauss_energy: f64,
    pub(crate) gauss_ended: Option<Ended>,
    pub(crate) seconds: f64,
    pub(crate) gauss_seconds: f64,
}

impl Measured {
    /// Trajectory error of EQUIP over that of Gauss.
    pub(crate) fn ratio(&self) -> Option<f64> {
        let (error, gauss) = (self.error?, self.gauss_error?);
        Some(if error == gauss { 1.0 } else { error / gauss })
    }

    /// The invariant that is off by most round-offs.
    pub(crate) fn worst_invariant(&self) -> Option<&Kept> {
        let worse = |a: &&Kept, b: &&Kept| a.in_roundoff.total_cmp(&b.in_roundoff);
        self.invariants.iter().max_by(worse)
    }
}
