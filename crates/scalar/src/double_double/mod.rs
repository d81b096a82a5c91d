//! [`DoubleDouble`]: about 31 digits, as an unevaluated sum of two `f64`.
//!
//! x = hi + lo with hi = RN(hi + lo), so |lo| ≤ ulp(hi)/2. Own code throughout: no libm function but the correctly rounded
//! `sqrt` and fused multiply-add, hence the same bits on every platform. The latter is a call on plain x86-64, so that single numbers call it only where
//! products split by Dekker are not exact; in vectors it is an instruction.
//!
//! | | largest relative error proved or measured, in units of 2⁻¹⁰⁴ |
//! |---|---|
//! | + − | 0.75 (Joldes–Muller–Popescu 2017, algorithm 6) |
//! | × | 1.25 (Muller–Rideau 2022, for algorithm 10 of JMP) |
//! | ÷ | 3.75 (JMP, algorithm 17) |
//! | √ | 0.79 (Lefèvre–Louvet–Muller–Picot–Rideau 2023) |
//! | xⁿ | measured 0.4 n |
//! | xʸ | 8 + 4 \|y ln x\|, measured a fifth of it; integers up to 64 as xⁿ |
//! | all other functions | measured 1.4 (`tests/double_double_functions.rs`) |
//!
//! What it is not: correctly rounded, or monotone in the last bit. Below [`DoubleDouble::MIN_POSITIVE`] = 2⁻⁹⁶⁹
//! the lower part runs into the subnormal numbers and precision fades as it does for `f64` below 2⁻¹⁰²².
//! NaN and infinities follow the rules of `f64`; both are stored with lo = 0.
//!
//! References, cited by short name in the files:
//! - Dekker, *A floating-point technique for extending the available precision*, Numer. Math. 18 (1971).
//! - Knuth, *The Art of Computer Programming* 2, 4.2.2 (two-sum; also Møller 1965).
//! - JMP: Joldes, Muller, Popescu, *Tight and rigorous error bounds for basic building blocks of double-word
//!   arithmetic*, ACM TOMS 44 (2017) 15.
//! - Hida, Li, Bailey, *Library for double-double and quad-double arithmetic* (2007), "QD".
//! - Tang, *Table-driven implementation of the exponential / logarithm function*, ACM TOMS 15, 16 (1989, 1990).

mod arithmetic;
mod constants;
mod exponential;
mod inverse;
mod lanes;
mod logarithm;
mod natural;
mod parse;
mod print;
mod reduction;
mod roots;
mod rounding;
mod tables;
mod traits;
mod transforms;
mod trigonometric;
mod words;

pub use lanes::DoubleDoubles;

use std::num::FpCategory;
use transforms::{fast_two_sum, power_of_two, two_sum};

/// About 31 digits: an unevaluated sum of two doubles, `hi` being the sum rounded.
///
/// ```
/// use equip_scalar::DoubleDouble;
/// let third = DoubleDouble::ONE / DoubleDouble::from(3.0);
/// assert_eq!(format!("{third:.30}"), "0.333333333333333333333333333333");
/// assert_eq!("0.1".parse::<DoubleDouble>().map(|x| x.to_string()), Ok("0.1".to_string()));
/// ```
///
/// Comparison is by value; −0 equals 0 and NaN equals nothing.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

/// A pair that is known to be normalised.
const fn dd(hi: f64, lo: f64) -> DoubleDouble {
    DoubleDouble { hi, lo }
}

impl DoubleDouble {
    /// hi + lo for any two doubles: their sum, exactly.
    #[inline]
    pub fn new(hi: f64, lo: f64) -> Self {
        let (sum, rest) = two_sum(hi, lo);
        if lo == 0.0 {
            return Self::from(hi);
        }
        if rest.is_nan() {
            Self::from(hi + lo)
        } else {
            dd(sum, rest)
        }
    }

    /// A double, exactly, also in constants.
    #[inline(always)]
    pub const fn small(x: f64) -> Self {
        dd(x, 0.0)
    }

    /// The upper part: the number rounded to a double.
    #[inline(always)]
    pub const fn hi(self) -> f64 {
        self.hi
    }

    /// The lower part: what [`hi`](Self::hi) leaves out.
    #[inline(always)]
    pub const fn lo(self) -> f64 {
        self.lo
    }

    /// The number as an unevaluated sum, largest part first.
    #[inline(always)]
    pub const fn expansion(self) -> [f64; 4] {
        [self.hi, self.lo, 0.0, 0.0]
    }

    #[inline(always)]
    fn words(self) -> (f64, f64) {
        (self.hi, self.lo)
    }

    /// From words that are known to be normalised.
    #[inline(always)]
    fn of((hi, lo): (f64, f64)) -> Self {
        dd(hi, lo)
    }

    /// From parts of which the first is not smaller than the second.
    #[inline(always)]
    fn ordered(hi: f64, lo: f64) -> Self {
        let (hi, lo) = fast_two_sum(hi, lo);
        dd(hi, lo)
    }

    /// x·2ᵏ, rounded only where the result is subnormal; overflow gives an infinity.
    fn scale(self, k: i32) -> Self {
        if self.hi == 0.0 || !self.hi.is_finite() {
            return self;
        }
        let mut k = k.clamp(-4500, 4500);
        let mut x = self;
        while k != 0 {
            let step = k.clamp(-1000, 1000);
            let factor = power_of_two(step);
            x = dd(x.hi * factor, x.lo * factor);
            k -= step;
        }
        if x.hi.is_finite() {
            Self::new(x.hi, x.lo)
        } else {
            Self::from(x.hi)
        }
    }

    /// Whether the number is NaN.
    #[inline(always)]
    pub const fn is_nan(self) -> bool {
        self.hi.is_nan()
    }

    /// Whether the number is neither infinite nor NaN.
    #[inline(always)]
    pub const fn is_finite(self) -> bool {
        self.hi.is_finite()
    }

    /// Whether the number is an infinity.
    #[inline(always)]
    pub const fn is_infinite(self) -> bool {
        self.hi.is_infinite()
    }

    /// Zero, normal, subnormal, infinite or NaN, as the upper part is.
    pub const fn classify(self) -> FpCategory {
        self.hi.classify()
    }

    /// Whether the sign bit is clear.
    #[inline(always)]
    pub const fn is_sign_positive(self) -> bool {
        self.hi.is_sign_positive()
    }

    /// Whether the sign bit is set.
    #[inline(always)]
    pub const fn is_sign_negative(self) -> bool {
        self.hi.is_sign_negative()
    }

    /// |x|.
    #[inline(always)]
    pub fn abs(self) -> Self {
        if self.hi.is_sign_negative() {
            -self
        } else {
            self
        }
    }

    /// 1 with the sign of the number; NaN of NaN.
    pub fn signum(self) -> Self {
        Self::from(self.hi.signum())
    }

    /// |x| with the sign of `sign`.
    pub fn copysign(self, sign: Self) -> Self {
        if self.hi.is_sign_negative() == sign.hi.is_sign_negative() {
            self
        } else {
            -self
        }
    }

    /// The smaller of two; a NaN is ignored.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        if self <= other || other.is_nan() {
            self
        } else {
            other
        }
    }

    /// The larger of two; a NaN is ignored.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        if self >= other || other.is_nan() {
            self
        } else {
            other
        }
    }
}

impl From<f64> for DoubleDouble {
    #[inline(always)]
    fn from(x: f64) -> Self {
        dd(x, 0.0)
    }
}

impl From<f32> for DoubleDouble {
    #[inline(always)]
    fn from(x: f32) -> Self {
        dd(f64::from(x), 0.0)
    }
}

impl From<i32> for DoubleDouble {
    #[inline(always)]
    fn from(n: i32) -> Self {
        dd(f64::from(n), 0.0)
    }
}
