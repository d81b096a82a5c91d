//! Derivatives: appended to a recording, or propagated along a replay.

pub(crate) mod bound;
pub(crate) mod exact;
mod functions;
pub(crate) mod hessian;
pub(crate) mod reverse;
pub(crate) mod rounded;
mod twos;
