//! Whole runs over an interval.

pub(crate) mod chaos_watch;
pub(crate) mod dense_watch;
pub(crate) mod drive;
pub(crate) mod integrate;
pub(crate) mod observer;
pub(crate) mod outputs;
pub(crate) mod prepared;
pub(crate) mod run;
pub(crate) mod suggest;
