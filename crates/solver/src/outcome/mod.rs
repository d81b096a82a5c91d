//! The result of a step.

pub(crate) mod failure;
pub(crate) mod outcome;
pub(crate) mod parts;
