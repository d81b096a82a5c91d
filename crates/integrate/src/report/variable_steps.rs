//! [`VariableSteps`]: statistics of step control in a run.

use equip_scalar::Float;

/// Statistics of step control.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VariableSteps<T> {
    /// The requested tolerance.
    pub tolerance: T,
    /// The smallest accepted step. A step shortened to meet the end of the run does not count.
    pub smallest: T,
    /// The largest accepted step.
    pub largest: T,
    /// The number of steps rejected because of their error estimate.
    pub rejected: u64,
    /// The number of attempts that failed because their stages or an admissible α were not found.
    pub failed: u64,
}

impl<T: Float> VariableSteps<T> {
    /// For a run that begins.
    pub(crate) fn new(tolerance: T) -> Self {
        VariableSteps {
            tolerance,
            smallest: T::INFINITY,
            largest: T::int(0),
            rejected: 0,
            failed: 0,
        }
    }
}
