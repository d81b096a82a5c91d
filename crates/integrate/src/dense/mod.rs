//! Dense output: the state between the ends of a step.

mod numbers;
pub(crate) mod piece;
pub(crate) mod polynomial;
pub(crate) mod refine;
pub(crate) mod trajectory;
