//! What is known of a step when it is done.

pub(crate) mod failure;
pub(crate) mod outcome;
pub(crate) mod parts;
