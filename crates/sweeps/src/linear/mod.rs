//! The stage equations linearised.

pub(crate) mod linear_sweeps;
pub(crate) mod positions;
pub(crate) mod stage_hessians;
