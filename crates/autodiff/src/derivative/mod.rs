//! Derivatives: appended to a trace, or propagated by a replay.

pub(crate) mod bound;
pub(crate) mod exact;
mod functions;
pub(crate) mod hessian;
pub(crate) mod reverse;
pub(crate) mod rounded;
mod twos;
