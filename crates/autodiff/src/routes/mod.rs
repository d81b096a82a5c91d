//! The three ways to give H, and their evaluators.

pub(crate) mod bound;
pub(crate) mod check;
pub(crate) mod derived;
pub(crate) mod many;
pub(crate) mod one;
pub(crate) mod ready;
pub(crate) mod recorded;
pub(crate) mod recorded_evaluator;
pub(crate) mod results;
pub(crate) mod statics;
pub(crate) mod supplied;
