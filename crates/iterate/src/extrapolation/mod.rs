//! Extrapolation of the stages from the last step.

pub(crate) mod gradients;
pub(crate) mod polynomial;
