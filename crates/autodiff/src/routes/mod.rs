//! The evaluation of energies.

pub(crate) mod evaluator;
pub(crate) mod flow;
pub(crate) mod many;
pub(crate) mod results;
pub(crate) mod state_function;
pub(crate) mod switches;
pub(crate) mod traced;
pub(crate) mod traced_evaluator;
