//! Tangent vectors along a run.

pub(crate) mod chaos;
mod follow;
pub(crate) mod tangent_map;
