//! Factorisations and solves without allocation: dense LU in any field and, with the feature `sparse`, sparse
//! complex LU.
#![forbid(unsafe_code)]

mod dense_lu;
#[cfg(not(feature = "sparse"))]
mod no_sparse_lu;
#[cfg(feature = "sparse")]
mod sparse_lu;

pub use dense_lu::{DenseLu, Singular};
#[cfg(not(feature = "sparse"))]
pub use no_sparse_lu::{SparseLu, Symbolic};
#[cfg(feature = "sparse")]
pub use sparse_lu::{SparseLu, Symbolic};
