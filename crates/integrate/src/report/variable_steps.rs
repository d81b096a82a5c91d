//! [`VariableSteps`]: what step control did in a run.

/// What step control did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VariableSteps<T> {
    /// The tolerance asked for; ε of reversible steps.
    pub tolerance: T,
    /// Smallest step taken; a step cut to reach the end of the run does not count.
    pub smallest: T,
    /// Largest step taken.
    pub largest: T,
    /// Steps made and refused because their error estimate was too large.
    pub rejected: u64,
    /// Steps refused because their stages or α's were not found.
    pub failed: u64,
}
