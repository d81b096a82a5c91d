//! Gradient, Hessian and structure of a scalar energy H(q, p), from H alone.
//!
//! States are slices y = (q, p) of length n = 2m for m degrees of freedom: positions first, then momenta.
//!
//! | route | written as | derivatives |
//! |---|---|---|
//! | closure, [`Hamiltonian::new`] | `\|q, p\| ...` over [`Var`] | tapes of ∇H and ∇²H, in `f64` as machine code; any n |
//! | type, [`Hamiltonian::from_energy`] | [`Energy`], or the macro [`hamiltonian!`] | dual numbers for n ≤ 8, else the tape |
//! | closure of time, [`Hamiltonian::with_time`] | `\|t, q, p\| ...` over [`Var`] | of H + p_t, time and its momentum p_t as one more degree of freedom |
//! | either with a gradient | [`Energy::gradient`], [`Hamiltonian::with_gradient`] | the given gradient; Hessian by the tape |
//!
//! Machine code is made of arithmetic, √ and |x|, for x86-64 with AVX2 or AVX-512, at the first call; all
//! else is replayed from the tape. Every bit is the same.
//!
//! All are a [`System`], which makes an [`Evaluate`] for each float type. The value is the same on each route
//! to the last bit, and the same as that of the generic energy called with floats.
//!
//! Cost, in operations of H: a gradient one to three times as many; ∇²H·v about six; all entries of ∇²H one
//! to ten where each term of H has a few variables, and no more than six for each entry of the fullest row.
//! What is recorded is made at its first call: ∇²H takes some 2 µs an operation.
//!
//! Not supported: energies that branch on the state or read it out (refused when built), loops that wait for
//! convergence (use a fixed number of iterations), and functions beyond those of [`Num`](equip_scalar::Num).
//! What is none of them can be given as an [`Outside`](equip_scalar::Outside), as the tables and closures of
//! `equip-tables` are.
#![forbid(unsafe_code)]

mod derivative;
mod energy;
mod error;
mod hamiltonian;
#[doc(hidden)]
pub mod macros;
mod native;
mod recording;
mod replay;
mod routes;
mod structure;
mod system;

pub use energy::Energy;
pub use error::{BuildError, BytesError};
pub use hamiltonian::{Formula, Hamiltonian};
pub use recording::trace::{Trace, Var};
pub use routes::check::WrongGradient;
pub use routes::recorded::Recorded;
pub use routes::recorded_evaluator::RecordedEvaluator;
pub use routes::state_function::StateFunction;
pub use routes::statics::{Static, StaticEvaluator};
pub use routes::supplied::{Supplied, SuppliedEvaluator};
pub use routes::switches::{
    DomainEvaluator, Domains, OutsideDomain, SwitchEvaluator, SwitchKind, Switches,
};
pub use structure::facts::{HessianPattern, Structure};
pub use structure::kinetic::Kinetic;
pub use structure::pattern::Pattern;
pub use system::{Evaluate, System};

#[doc(hidden)]
pub use native::fused::{Fused, Slopes};
#[doc(hidden)]
pub use system::Holds;
