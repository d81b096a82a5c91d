//! Runs that are advanced step by step.

pub(crate) mod checkpoint;
pub(crate) mod domains;
pub(crate) mod event_step;
pub(crate) mod in_parts;
pub(crate) mod integration;
mod sizes;
pub(crate) mod start;
pub(crate) mod step_control;
pub(crate) mod stepper;
pub(crate) mod view;
