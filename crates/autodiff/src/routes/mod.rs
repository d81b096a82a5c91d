//! The three ways to give H, and their evaluators.

pub(crate) mod check;
mod evaluate;
pub(crate) mod many;
pub(crate) mod one;
pub(crate) mod recorded;
pub(crate) mod recorded_evaluator;
pub(crate) mod results;
pub(crate) mod state_function;
pub(crate) mod statics;
pub(crate) mod supplied;
pub(crate) mod switches;
