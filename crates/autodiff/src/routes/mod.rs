//! What is evaluated of an energy: of a trace, or of functions of the user's own.

pub(crate) mod check;
pub(crate) mod evaluator;
pub(crate) mod external;
pub(crate) mod given;
pub(crate) mod many;
pub(crate) mod one;
pub(crate) mod results;
pub(crate) mod state_function;
pub(crate) mod switches;
pub(crate) mod traced;
pub(crate) mod traced_evaluator;
