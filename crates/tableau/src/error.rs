//! [`TableauError`]: why a tableau cannot be constructed.

/// A requested tableau that does not exist.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableauError {
    /// The number of stages or of quadrature nodes is outside the supported range.
    #[error("{stages} stages or nodes are not supported; choose a number from {min} to {max}")]
    StagesOutOfRange {
        /// The number requested.
        stages: usize,
        /// The smallest supported number.
        min: usize,
        /// The largest supported number.
        max: usize,
    },
    /// HBVM(k, s) with fewer quadrature nodes k than its degree s.
    #[error(
        "HBVM({nodes}, {degree}) has fewer nodes than its degree; choose at least {degree} nodes"
    )]
    TooFewNodes {
        /// The number of quadrature nodes k.
        nodes: usize,
        /// The degree s of the polynomial.
        degree: usize,
    },
    /// A is not s × s for the s entries of b.
    #[error("A has {entries} entries for {stages} weights; give {stages} rows of {stages} entries")]
    ShapeMismatch {
        /// The number of entries of A.
        entries: usize,
        /// The number of weights.
        stages: usize,
    },
}
