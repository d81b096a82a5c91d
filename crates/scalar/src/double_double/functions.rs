//! Elementary functions of a [`DoubleDouble`](super::DoubleDouble).

mod error_function;
mod exponential;
mod inverse;
mod logarithm;
mod reduction;
mod roots;
mod tables;
mod trigonometric;
