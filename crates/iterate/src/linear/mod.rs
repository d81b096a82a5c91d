//! The linearised stage equations.

pub(crate) mod compiled;
pub(crate) mod linear_iteration;
pub(crate) mod positions;
pub(crate) mod power_iteration;
pub(crate) mod solve;
pub(crate) mod stage_hessians;
