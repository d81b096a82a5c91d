//! The options of a step.

pub(crate) mod family;
pub(crate) mod invariant;
pub(crate) mod step_options;
