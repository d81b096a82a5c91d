//! How the stages of a component lie in memory, and the state at both ends of a step.

pub(crate) mod aligned;
pub(crate) mod row;
pub(crate) mod state;
