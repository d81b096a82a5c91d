//! Runs without the GIL.

mod certificate;
pub(crate) mod ensemble;
mod keeping;
pub(crate) mod run;
mod signals;
pub(crate) mod steps;
