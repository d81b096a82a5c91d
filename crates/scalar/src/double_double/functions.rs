//! Elementary functions of a [`DoubleDouble`](super::DoubleDouble).

mod error_function;
mod exponential;
mod inverse;
mod logarithm;
pub(crate) mod reduction;
mod roots;
mod tables;
mod trigonometric;
