//! Why a step could not be made, without times and sizes: those of the part that failed are
//! [`Core::failed_part`](crate::Core::failed_part).

/// Why a step was not made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Failure<T> {
    /// H or its derivatives are infinite or NaN inside the step.
    #[error("H or its derivatives are not finite inside the step; take a smaller one")]
    NotFinite,
    /// The Newton matrix is singular.
    #[error("the Newton matrix is singular; take a slightly different step")]
    Singular,
    /// The stage equations were not solved.
    #[error("the stage equations did not converge; take a smaller step")]
    NoConvergence {
        /// Iterations of the last attempt.
        iterations: u32,
        /// Last correction, relative to the state.
        correction: T,
    },
    /// No admissible α keeps what is to be kept.
    #[error("no admissible α was found; take a smaller step or more stages")]
    NoAlpha,
    /// The stage equations have a solution that has nothing to do with the motion.
    #[error("the solution found does not follow the motion; take a smaller step")]
    Astray {
        /// What H changes by over the step.
        change: T,
        /// Σ_i h b_i Σ_c |q̇_c ṗ_c|, the energy exchanged in it.
        exchanged: T,
    },
}

/// A memory that does not fit the solver it is given to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the memory of the solver is damaged: {what} does not fit; start without it")]
pub struct Damaged {
    /// Which part.
    pub what: &'static str,
}
