//! One step: initial guess → stages → α → accept → update.

pub(crate) mod alphas;
mod astray;
pub(crate) mod compiled;
pub(crate) mod core;
pub(crate) mod stages;
pub(crate) mod step;
