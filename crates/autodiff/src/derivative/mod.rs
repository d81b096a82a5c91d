//! Derivatives: appended to a recording, or propagated along a replay.

pub(crate) mod bound;
pub(crate) mod exact;
pub(crate) mod hessian;
pub(crate) mod rate;
pub(crate) mod reverse;
mod slopes;
pub(crate) mod tangent;
mod twos;
