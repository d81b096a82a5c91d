//! [`DoubleDouble`]: about 31 digits, as an unevaluated sum of two `f64`.
//!
//! x = hi + lo with hi = RN(hi + lo), so |lo| ≤ ulp(hi)/2. Of libm only the correctly rounded `sqrt` and
//! fused multiply-add are used, hence the same bits on every platform. On plain x86-64 fused multiply-add is
//! a call. Single numbers use it only if Dekker's splitting is not exact; in vectors it is an instruction.
//!
//! | | largest relative error proved or measured, in units of 2⁻¹⁰⁴ |
//! |---|---|
//! | + − | 0.75 (Joldes–Muller–Popescu 2017, algorithm 6) |
//! | × | 1.25 (Muller–Rideau 2022, for algorithm 10 of JMP) |
//! | ÷ | 3.75 (JMP, algorithm 17) |
//! | √ | 0.79 (Lefèvre–Louvet–Muller–Picot–Rideau 2023) |
//! | xⁿ | measured 0.4 n |
//! | xʸ | 8 + 4 \|y ln x\|, measured a fifth of it; integers up to 64 as xⁿ |
//! | all other functions | measured 1.4 (`tests/double_double_functions`) |
//!
//! Results are not correctly rounded, and not monotone in the last bit. Below [`DoubleDouble::MIN_POSITIVE`]
//! = 2⁻⁹⁶⁹ the lower part is subnormal, and precision decreases as for `f64` below 2⁻¹⁰²². NaN and infinities
//! follow the rules of `f64`; both are stored with lo = 0.
//!
//! References, cited by short name in the files:
//! - Dekker, *A floating-point technique for extending the available precision*, Numer. Math. 18 (1971).
//! - Knuth, *The Art of Computer Programming* 2, 4.2.2 (two-sum; also Møller 1965).
//! - JMP: Joldes, Muller, Popescu, *Tight and rigorous error bounds for basic building blocks of double-word
//!   arithmetic*, ACM TOMS 44 (2017) 15.
//! - Hida, Li, Bailey, *Library for double-double and quad-double arithmetic* (2007), "QD".
//! - Tang, *Table-driven implementation of the exponential / logarithm function*, ACM TOMS 15, 16 (1989,
//!   1990).

mod arithmetic;
mod constants;
pub(crate) mod functions;
pub(crate) mod integers;
mod lanes;
mod number;
mod rounding;
pub(crate) mod text;
mod traits;
pub(crate) mod transforms;
mod words;

pub use lanes::DoubleDoubles;
pub use number::DoubleDouble;
