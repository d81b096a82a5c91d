//! Graphs as machine code, and computations compiled together with derivatives.

pub(crate) mod compiled;
pub(crate) mod fused;
pub(crate) mod straight;
