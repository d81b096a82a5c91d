//! Gradient, Hessian and structure of a scalar energy H(q, p), from H alone.
//!
//! States are slices y = (q, p) of length n = 2m for m degrees of freedom: positions first, then momenta.
#![forbid(unsafe_code)]

mod check;
mod colouring;
mod degree;
mod energy;
mod error;
mod graph;
mod hamiltonian;
mod hessian;
mod macros;
mod op;
mod recorded;
mod recorder;
mod replay;
mod reverse;
mod separable;
mod sparsity;
mod statics;
mod structure;
mod supplied;
mod system;
mod tangent;
mod tape;
mod trace;

pub use energy::Energy;
pub use error::BuildError;
pub use hamiltonian::Hamiltonian;
pub use recorded::{Recorded, RecordedEvaluator};
pub use statics::{Static, StaticEvaluator};
pub use structure::{Pattern, Structure};
pub use supplied::{Supplied, SuppliedEvaluator};
pub use system::{Evaluate, System};
pub use trace::{Trace, Var};

#[doc(hidden)]
pub use equip_scalar as scalar;
