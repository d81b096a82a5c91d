//! How far an iteration is from its solution.

pub(crate) mod again;
pub(crate) mod contraction;
