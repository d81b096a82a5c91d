//! [`TableauError`]: why a tableau could not be made.

/// A tableau that does not exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableauError {
    /// The number of stages, or of quadrature nodes, is outside what is offered.
    #[error("{stages} stages or nodes are not offered; choose a number from {min} to {max}")]
    StagesOutOfRange {
        /// The requested number.
        stages: usize,
        /// The smallest possible number.
        min: usize,
        /// The largest possible number.
        max: usize,
    },
    /// HBVM(k, s) with fewer quadrature nodes k than its degree s.
    #[error(
        "HBVM({nodes}, {degree}) has fewer nodes than its degree; choose at least {degree} nodes"
    )]
    TooFewNodes {
        /// The number of quadrature nodes k.
        nodes: usize,
        /// The degree s of the stage polynomial.
        degree: usize,
    },
    /// A is not s × s for the s entries of b.
    #[error(
        "{entries} entries in A do not go with {stages} weights; give {stages} rows of {stages} entries"
    )]
    ShapeMismatch {
        /// The number of entries of A.
        entries: usize,
        /// The number of weights.
        stages: usize,
    },
}
