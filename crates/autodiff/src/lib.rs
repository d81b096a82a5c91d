//! Gradient, Hessian and structure of a scalar energy H(q, p), from H alone.
//!
//! States are slices y = (q, p) of length n = 2m for m degrees of freedom: positions first, then momenta.
//!
//! | an energy | written as | derivatives |
//! |---|---|---|
//! | [`Hamiltonian::new`] | `\|q, p\| ...` over [`Var`] | by reverse mode from the trace of H, in `f64` as machine code |
//! | [`Hamiltonian::with_time`] | `\|t, q, p\| ...` over [`Var`] | of H + p_t, with time and its momentum p_t as one more degree of freedom |
//! | either [`with_gradient`](Hamiltonian::with_gradient) | and `\|q, p, dq, dp\| ...` over `f64` | the given gradient in `f64`; Hessian from the trace |
//! | [`Hamiltonian::of_state`] [`with_bracket`](Hamiltonian::with_bracket) | `\|y\| ...` over [`Var`], H and B(y) | of y' = B(y)∇H(y) |
//! | [`Hamiltonian::external`] | value and gradient over `f64` | the given gradient; Hessian by differences |
//!
//! At the first call, an energy of arithmetic, √ and |x| is compiled to machine code for x86-64 with AVX2 or
//! AVX-512. Other energies are replayed from a tape. Both give the same results bit for bit.
//!
//! An [`Evaluator`] computes values and derivatives in one floating-point type.
//!
//! Cost, in operations of H: a gradient one to three times as many; ∇²H·v about six times; all entries of ∇²H
//! one to ten times if each term of H has a few variables, and no more than six for each entry of the fullest
//! row. A trace of derivatives is computed at its first use; that of ∇²H takes about 2 µs an operation.
//!
//! Not supported: energies that branch on the state or read it out (an error when built), loops that wait for
//! convergence (use a fixed number of iterations), and functions beyond those of [`Num`](equip_scalar::Num).
//! Other functions can be given as an [`Outside`](equip_scalar::Outside), such as the tables and closures of
//! `equip-tables`.
#![forbid(unsafe_code)]

mod derivative;
mod error;
mod external;
mod formula;
mod hamiltonian;
mod native;
mod poisson;
mod recording;
mod replay;
mod routes;
mod structure;

pub use error::{BuildError, BytesError};
pub use external::check::WrongGradient;
pub use formula::Formula;
pub use hamiltonian::Hamiltonian;
pub use recording::trace::{Trace, Var};
pub use routes::evaluator::Evaluator;
pub use routes::state_function::StateFunction;
pub use routes::switches::{
    DomainEvaluator, Domains, OutsideDomain, SwitchEvaluator, SwitchKind, Switches,
};
pub use structure::facts::{HessianPattern, Structure};
pub use structure::kinetic::Kinetic;
pub use structure::pattern::Pattern;

#[doc(hidden)]
pub use native::fused::{Fused, StageGradients};
#[doc(hidden)]
pub use structure::conjugate::{conjugate, turned};
