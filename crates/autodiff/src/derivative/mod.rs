//! Derivatives: appended to a recording, carried along a replay, or by dual numbers.

pub(crate) mod bound;
pub(crate) mod by_duals;
pub(crate) mod dual;
pub(crate) mod exact;
pub(crate) mod hessian;
pub(crate) mod rate;
pub(crate) mod reverse;
mod slopes;
pub(crate) mod tangent;
mod twos;
