//! Runge–Kutta tableaux of the Gauss and EQUIP families in any [`Float`](equip_scalar::Float) type.
#![forbid(unsafe_code)]

mod error;
mod gauss;
mod legendre;
mod rule;
mod skew;

pub use error::TableauError;
pub use gauss::{Gauss, MAX_STAGES};
pub use legendre::{legendre_at, legendre_derivatives_at, legendre_integrals_at};
