//! The properties of H that hold at every state.

pub(crate) mod bracket;
pub(crate) mod colouring;
pub(crate) mod conjugate;
pub(crate) mod degree;
pub(crate) mod facts;
pub(crate) mod kinetic;
pub(crate) mod pattern;
pub(crate) mod separable;
pub(crate) mod sparsity;
