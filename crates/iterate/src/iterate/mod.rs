//! The stages and their iteration.

pub(crate) mod begin;
pub(crate) mod compiled;
pub(crate) mod fixed_point;
pub(crate) mod form;
pub(crate) mod increments;
pub(crate) mod iterate;
pub(crate) mod moved;
pub(crate) mod precondition;
