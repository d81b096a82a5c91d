//! The programs and methods that are compared.

pub mod composition;
pub mod ours;
pub mod python;
pub mod rust_peers;
