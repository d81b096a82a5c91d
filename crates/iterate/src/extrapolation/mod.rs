//! What the last step says about the stages of this one.

pub(crate) mod gradients;
pub(crate) mod polynomial;
