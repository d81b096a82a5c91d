//! Roots of functions along a run.

pub(crate) mod roots;
pub(crate) mod watch;
