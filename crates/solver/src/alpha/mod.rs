//! Which way the α's move, and how far.

pub(crate) mod direction;
pub(crate) mod least_displacement;
pub(crate) mod local_error;
pub(crate) mod progress;
