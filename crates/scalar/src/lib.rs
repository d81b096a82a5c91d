//! Floating-point types of the equip integrators.
//!
//! | type or trait | meaning |
//! |---|---|
//! | [`Scalar`] | arithmetic and elementary functions, **no ordering**: what an energy H may use |
//! | [`Float`] | a [`Scalar`] with ordering, ε, exact ratios and parsed decimals: the type of a run |
//! | [`Outside`] | an external function with its derivatives, such as a table |
//! | [`Recording`] | the [`Scalar`] that traces operations; it has no value, and comparisons are rejected |
//! | [`Num`] | the wrapper in a user's energy: `0.5 * q[0]`, `q[0].sin()`, never `q[0] < 1.0` |
//! | [`Constant`] | a constant in H that is exact in every floating-point type |
//! | [`DoubleDouble`] | about 31 digits, as an unevaluated sum of two `f64` |
//! | [`Own`] | a user-defined floating-point type, given by its [`Arithmetic`] |
//! | [`Lanes`], [`DoubleDoubles`] | N doubles or double-doubles at once, one for each stage; vector instructions inside a [`Kernel`] |
//! | [`Pack`] | either of them, in generic code |
//! | [`power`] | log₂, 2ˣ and xᵃ to eight digits, with the same bits on every machine: for step sizes, not for results |
//! | [`Forward`] | dual numbers with first derivatives (through num-dual) |
//!
//! `Scalar` declares its functions without a receiver (`S::sin(x)`, not `x.sin()`), so that in code generic
//! over [`Float`] the call `x.sin()` unambiguously means that of nalgebra's
//! [`RealField`](nalgebra::RealField).
// Not `forbid`, for two exceptions: simba's `SimdValue` makes every implementor declare two `unsafe fn` (in
// `glue`, without an unsafe operation), and `instructions` calls functions compiled for instructions that the
// processor was found to have.
#![deny(unsafe_code)]

#[macro_use]
mod glue;

mod constant;
mod double;
mod double_double;
mod error;
mod forward;

mod kernels;
mod num;
mod own;
mod ready;
mod traits;

pub use constant::{Constant, Words, Written, decimal, ratio};
pub use double_double::{DoubleDouble, DoubleDoubles};
pub use error::ParseFloatError;
pub use forward::Forward;
pub use kernels::power;
pub use kernels::stages::mix_stages;
pub use kernels::{InstructionSet, Kernel, Lanes};
pub use num::Num;
pub use own::{Arithmetic, Own};
#[doc(hidden)]
pub use ready::same;
#[doc(hidden)]
pub use traits::plain;
pub use traits::{Attempt, FirstOrder, Float, Outside, Pack, Recording, Scalar};
