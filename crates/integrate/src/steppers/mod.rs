//! Runs made step by step.

pub(crate) mod adaptive_checkpoint;
pub(crate) mod adaptive_stepper;
pub(crate) mod fixed_checkpoint;
pub(crate) mod reversible_stepper;
pub(crate) mod start;
pub(crate) mod stepper;
pub(crate) mod view;
