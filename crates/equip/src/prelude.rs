//! The names that a program needs to integrate its own Hamiltonian: `use equip::prelude::*;`.
//!
//! All other names have a path: options, steppers and results in [`crate::integrate`], floating-point types
//! in [`crate::scalar`], errors of H in [`crate::autodiff`] and [`crate::tables`].

pub use equip_autodiff::{Hamiltonian, Var};
pub use equip_integrate::{
    Certificate, Checkpoint, Equip, Event, Gauss, Invariant, Method, Outcome, Record, Run,
    TangentMap, Target,
};
pub use equip_scalar::{DoubleDouble, Float, decimal, ratio};
pub use equip_tables::{Custom, Table, Table2};
