//! Complete runs over an interval.

pub(crate) mod compiled;
pub(crate) mod dense_watch;
pub(crate) mod drive;
#[cfg(feature = "rayon")]
pub(crate) mod ensemble;
pub(crate) mod integrate;
pub(crate) mod observer;
pub(crate) mod outputs;
pub(crate) mod prepared;
pub(crate) mod run;
pub(crate) mod step_events;
pub(crate) mod suggest;
