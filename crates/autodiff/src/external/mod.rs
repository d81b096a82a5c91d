//! Energies and gradients computed by user code.

pub(crate) mod check;
pub(crate) mod energy;
pub(crate) mod given;
