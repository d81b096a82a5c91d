//! Roots of event functions and switches along a run.

pub(crate) mod crossings;
pub(crate) mod hidden;
pub(crate) mod narrow;
pub(crate) mod path;
pub(crate) mod roots;
pub(crate) mod roughness;
pub(crate) mod watch;
