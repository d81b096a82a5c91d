//! Small deviations along a run.

pub(crate) mod chaos;
pub(crate) mod tangent_map;
