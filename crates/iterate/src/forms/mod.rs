//! The forms of a fixed-point iteration.

pub(crate) mod form;
pub(crate) mod full;
pub(crate) mod fused;
pub(crate) mod incremental;
pub(crate) mod separable;
