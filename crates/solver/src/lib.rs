//! One step of the energy and quadratic invariants preserving (EQUIP) methods for Hamiltonian systems y' = J∇H(y).
//!
//! One step reads: initial guess (`guess`) → stages and α (`stages`, `constraint`, `linearised`, `alpha`, `newton`) →
//! accept or halve (`step`) → update (`state`). Time, runs and their certificates are `equip-integrate`'s, which needs
//! of a step what [`Core::new`], [`Core::step`] and `access.rs` give.
//!
//! Paper: L. Brugnano, F. Iavernaro, D. Trigiante, *Energy and quadratic invariants preserving integrators of Gaussian
//! type*, AIP Conf. Proc. 1281 (2010), and arXiv:1005.1930.
#![forbid(unsafe_code)]

mod access;
mod ahead;
mod aligned;
mod alpha;
mod columns;
mod constraint;
mod contraction;
mod dear;
mod decay;
mod displaced;
mod displacement;
mod draft;
mod endpoint;
mod failure;
mod family;
mod finer;
mod foresee;
mod guess;
mod half;
mod hessians;
mod invariant;
mod linear;
mod linear_sweeps;
mod linearisation;
mod linearised;
mod linearised_columns;
mod local_error;
mod memory;
mod mix;
mod moves;
mod newton;
mod newton_alphas;
mod one_more;
mod opening;
mod options;
mod outcome;
mod pairs;
mod parts;
mod product;
mod prolongation;
mod ready;
mod refined;
mod response;
mod row;
mod shifted;
mod simplified;
mod slight;
mod slopes;
mod slow;
mod small;
mod sparse;
mod splitting;
mod springs;
mod stages;
mod start;
mod state;
mod step;
mod step_swept;
mod step_tangent;
mod sweep;
mod sweep_task;
mod sweeps;
mod twice;
mod whole;

pub use access::FailedPart;
pub use constraint::Constraint;
pub use decay::decay;
pub use failure::{Damaged, Failure};
pub use family::{Alphas, Family};
pub use invariant::Invariant;
pub use memory::SolverMemory;
pub use newton::NewtonRecord;
pub use options::{OnNoAlpha, StageSolver, StepOptions};
pub use outcome::{Counts, Outcome};
pub use parts::Part;
pub use row::stride_for;
pub use springs::most_resolved;
pub use state::State;
pub use step::Core;
pub use step_tangent::StepTangent;

/// Most stages a method may have.
pub const MAX_STAGES: usize = 32;
