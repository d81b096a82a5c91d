//! Runs without the GIL.

pub(crate) mod between;
mod certificate;
pub(crate) mod claim;
pub(crate) mod curve;
pub(crate) mod ensemble;
mod keeping;
pub(crate) mod patience;
pub(crate) mod run;
mod signals;
pub(crate) mod steps;
