//! Factorisations that are made and used without allocation: dense LU in any field, sparse complex LU.
#![forbid(unsafe_code)]

mod dense_lu;
mod sparse_lu;

pub use dense_lu::{DenseLu, Singular};
pub use sparse_lu::{SparseLu, Symbolic};
