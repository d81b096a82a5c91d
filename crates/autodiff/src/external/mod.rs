//! Energies, and gradients, that are code of the user's own.

pub(crate) mod check;
pub(crate) mod energy;
pub(crate) mod given;
