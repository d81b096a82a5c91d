//! Whole runs over an interval.

pub(crate) mod adaptive_run;
pub(crate) mod chaos_watch;
pub(crate) mod dense_watch;
pub(crate) mod drive;
pub(crate) mod fixed_run;
pub(crate) mod grid;
pub(crate) mod observer;
pub(crate) mod outputs;
pub(crate) mod reversible_run;
pub(crate) mod run;
pub(crate) mod suggest;
