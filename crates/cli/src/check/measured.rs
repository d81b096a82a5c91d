//! [`Measured`]: the figures of a row.

use super::leg::{Kept, Leg};

/// The figures of both methods, and of their trajectories.
#[derive(Debug, Clone, Default)]
pub(crate) struct Measured {
    pub(crate) equip: Leg,
    pub(crate) gauss: Leg,
    pub(crate) error: Option<f64>,
    pub(crate) gauss_error: Option<f64>,
    /// Error of Gauss from a start that is changed by one unit in the last place: what round-off does to the
    /// trajectory.
    pub(crate) noise: Option<f64>,
}

impl Measured {
    /// Trajectory error of equip over that of Gauss.
    pub(crate) fn ratio(&self) -> Option<f64> {
        let (error, gauss) = (self.error?, self.gauss_error?);
        Some(if error == gauss { 1.0 } else { error / gauss })
    }

    /// The invariant that is off by most round-offs.
    pub(crate) fn worst_invariant(&self) -> Option<&Kept> {
        let worse = |a: &&Kept, b: &&Kept| a.in_roundoff.total_cmp(&b.in_roundoff);
        self.equip.invariants.iter().max_by(worse)
    }

    /// The worse of the solver's and the independent figure.
    pub(crate) fn levels(&self) -> Option<f64> {
        let equip = &self.equip;
        match (equip.levels, equip.independent_levels) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (a, b) => a.or(b),
        }
    }
}
