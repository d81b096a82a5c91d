//! The options of a run: steps, method, events.

pub(crate) mod adaptive;
pub(crate) mod common;
pub(crate) mod event;
pub(crate) mod integrator;
pub(crate) mod method;
pub(crate) mod record;
pub(crate) mod tolerance;
