//! [`VariableSteps`]: what step control did in a run.

use equip_scalar::Float;

/// What step control did.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VariableSteps<T> {
    /// The requested tolerance.
    pub tolerance: T,
    /// Smallest step taken; a step cut to reach the end of the run does not count.
    pub smallest: T,
    /// Largest step taken.
    pub largest: T,
    /// Steps made and refused because their error estimate was too large.
    pub rejected: u64,
    /// Steps refused because their stages or α_k were not found.
    pub failed: u64,
}

impl<T: Float> VariableSteps<T> {
    /// Of a run that begins.
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
