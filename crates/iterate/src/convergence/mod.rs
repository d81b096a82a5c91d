//! Convergence of the iteration.

pub(crate) mod again;
pub(crate) mod contraction;
