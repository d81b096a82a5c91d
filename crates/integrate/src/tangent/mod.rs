//! Small deviations along a run.

pub(crate) mod chaos;
pub(crate) mod steps;
pub(crate) mod tangent_map;
