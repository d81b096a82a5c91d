//! One step of the energy and quadratic invariants preserving (EQUIP) methods for Hamiltonian systems y' =
//! J∇H(y).
//!
//! A step is: initial guess → stages → α → accept → update, in `step/step.rs`. Its equations are those of
//! `tests/oracle.rs`. Time, runs and their certificates belong to `equip-integrate`, which uses
//! [`Core::new`], [`Core::step`] and the methods in `access.rs`.
//!
//! Paper: L. Brugnano, F. Iavernaro, D. Trigiante, *Energy and quadratic invariants preserving integrators of
//! Gaussian type*, AIP Conf. Proc. 1281 (2010), and arXiv:1005.1930.
#![forbid(unsafe_code)]

mod access;
mod alpha;
mod constraint;
mod memory;
mod options;
mod outcome;
mod policy;
mod precondition;
mod step;
mod step_tangent;
#[cfg(test)]
mod tests;

pub use constraint::Constraint;
pub use equip_iterate::{MAX_STAGES, PowerIteration, State, stride_for};
pub use memory::SolverMemory;
pub use options::family::{Alphas, Family};
pub use options::invariant::Invariant;
pub use options::step_options::{AlphaPolicy, Preconditioner, StepOptions};
pub use outcome::failure::{FailedPart, Failure};
pub use outcome::outcome::{Counts, Outcome};
pub use outcome::parts::Part;
pub use step::core::Core;
pub use step_tangent::StepTangent;
