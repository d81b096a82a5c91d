//! The programs and methods that are compared.

mod coefficients;
pub mod composition;
pub mod ours;
pub mod python;
pub mod rust_peers;
