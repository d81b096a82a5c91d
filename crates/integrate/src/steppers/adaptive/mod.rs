//! Steps that follow a tolerance.

pub(crate) mod adaptive_steps;
mod control;
pub(crate) mod made;
mod over_switches;
