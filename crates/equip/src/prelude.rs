//! What a program that integrates its own Hamiltonian names: `use equip::prelude::*;`.
//!
//! All else has its place by path: options, steppers and figures in [`crate::integrate`], number types in
//! [`crate::scalar`], errors of H in [`crate::autodiff`] and [`crate::tables`].

pub use equip_autodiff::{Hamiltonian, Var};
pub use equip_integrate::{
    Certificate, Checkpoint, Equip, Event, Gauss, Invariant, Method, Outcome, Record, Run,
    TangentMap, Target,
};
pub use equip_scalar::{DoubleDouble, Float, decimal, ratio};
pub use equip_tables::{Custom, Table, Table2};
