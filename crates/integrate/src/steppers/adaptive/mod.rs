//! Steps that follow a tolerance.

pub(crate) mod adaptive_stepper;
pub(crate) mod adaptive_steps;
pub(crate) mod made;
mod over_switches;
