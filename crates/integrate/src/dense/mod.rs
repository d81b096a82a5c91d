//! The state between the ends of a step.

pub(crate) mod piece;
pub(crate) mod polynomial;
pub(crate) mod refine;
pub(crate) mod trajectory;
