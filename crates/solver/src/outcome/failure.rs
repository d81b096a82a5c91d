//! Why a step failed. The time and size of the failed part are in
//! [`Core::failed_part`](crate::Core::failed_part).

/// The part of a step that failed last, or the complete step if it was not halved.
#[derive(Debug)]
pub struct FailedPart<T> {
    /// y at the start of the part, length n.
    pub start: Vec<T>,
    /// The time at the start of the part.
    pub time: T,
    /// The size of the part.
    pub step: T,
    /// How often the step could have been halved.
    pub max_halvings: u32,
}

/// Why a step failed.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Failure<T> {
    /// H or its derivatives are infinite or NaN inside the step.
    #[error("H or its derivatives are not finite inside the step; use a smaller step")]
    NotFinite,
    /// The Newton matrix is singular.
    #[error("the Newton matrix is singular; use a slightly different step")]
    Singular,
    /// The stage equations were not solved.
    #[error("the iteration for the stages did not converge; use a smaller step")]
    NoConvergence {
        /// The iterations of the last attempt.
        iterations: u32,
        /// The last change of the stages, relative to the state.
        correction: T,
    },
    /// No admissible α satisfies the constraints.
    #[error("no admissible α was found; use a smaller step or more stages")]
    NoAlpha,
    /// The iteration converged to a spurious solution of the stage equations.
    #[error(
        "the iteration converged to a spurious solution of the stage equations; use a smaller step"
    )]
    Astray {
        /// The change of H over the step.
        change: T,
        /// Σ_i h b_i Σ_c |q̇_c ṗ_c|, the energy exchanged between positions and momenta in the step.
        exchanged: T,
    },
}
