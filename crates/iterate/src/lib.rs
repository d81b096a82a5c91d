//! The stage equations of a Gauss-type step, Z = K(α) L(Z), as a fixed-point iteration in any floating-point
//! type.
//!
//! This crate contains the layout of the stages, the products with K(α), the extrapolation from step to step,
//! the contraction of the iteration and the linearised equations. The energy constraint, the rule for α and
//! the options belong to the solver.
//!
//! An *iteration* is one evaluation Z ← K(α) L(Z) for all stages.
#![forbid(unsafe_code)]

mod convergence;
mod extrapolation;
mod forms;
mod iterate;
mod layout;
mod linear;
mod matrix;
mod policy;

pub use convergence::contraction::{Contraction, Progress};
pub use extrapolation::polynomial::Polynomial;
pub use iterate::iterate::Iterate;
pub use iterate::moved::Kept;
pub use iterate::precondition::{Held, Preconditioner};
pub use layout::row::stride_for;
pub use layout::state::State;
pub use linear::linear_iteration::LinearIteration;
pub use linear::power_iteration::PowerIteration;

pub use policy::MOST_ITERATIONS;

pub use equip_tableau::MAX_STAGES;
