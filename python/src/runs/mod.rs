//! Runs without the GIL.

mod certificate;
pub(crate) mod ensemble;
pub(crate) mod run;
mod signals;
pub(crate) mod steps;
