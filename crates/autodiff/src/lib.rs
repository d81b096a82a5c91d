//! Gradient, Hessian and structure of a scalar energy H(q, p), from H alone.
//!
//! States are slices y = (q, p) of length n = 2m for m degrees of freedom: positions first, then momenta.
#![forbid(unsafe_code)]

mod structure;
mod system;

pub use structure::{Pattern, Structure};
pub use system::{Evaluate, System};
