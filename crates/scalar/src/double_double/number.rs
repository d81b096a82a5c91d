//! [`DoubleDouble`] itself: two words, their order and their signs.

use super::transforms::{exponent, fast_two_sum, power_of_two, two_sum};
use std::num::FpCategory;

/// About 31 digits: an unevaluated sum of two doubles, where `hi` is the rounded sum.
///
/// ```
/// use equip_scalar::DoubleDouble;
/// let third = DoubleDouble::ONE / DoubleDouble::from(3.0);
/// assert_eq!(format!("{third:.30}"), "0.333333333333333333333333333333");
/// let tenth: DoubleDouble = "0.1".parse()?;
/// assert_eq!(tenth.to_string(), "0.1");
/// assert_eq!(tenth.hi(), 0.1);
/// assert!(tenth.lo() != 0.0);
/// # Ok::<(), equip_scalar::ParseFloatError>(())
/// ```
///
/// Decimals are correctly rounded, twice: hi is the nearest double, lo the double nearest to the rest.
/// Comparison is by value; −0 equals 0 and NaN equals nothing.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub struct DoubleDouble {
    pub(super) hi: f64,
    pub(super) lo: f64,
}

/// A pair that is known to be normalised.
pub(super) const fn dd(hi: f64, lo: f64) -> DoubleDouble {
    DoubleDouble { hi, lo }
}

impl DoubleDouble {
    /// The exact sum of two doubles.
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

    /// The lower part: the rounding error of [`hi`](Self::hi).
    #[inline(always)]
    pub const fn lo(self) -> f64 {
        self.lo
    }

    /// The number as an unevaluated sum, largest part first.
    #[inline(always)]
    pub const fn expansion(self) -> [f64; 6] {
        [self.hi, self.lo, 0.0, 0.0, 0.0, 0.0]
    }

    /// The words, largest first.
    pub(super) fn array(self) -> [f64; 2] {
        [self.hi, self.lo]
    }

    /// ⌊log₂|x|⌋ of the upper part.
    pub(super) fn exponent(self) -> i32 {
        exponent(self.hi)
    }

    #[inline(always)]
    pub(super) fn words(self) -> (f64, f64) {
        (self.hi, self.lo)
    }

    /// From words that are known to be normalised.
    #[inline(always)]
    pub(super) fn of((hi, lo): (f64, f64)) -> Self {
        dd(hi, lo)
    }

    /// From parts of which the first is not smaller than the second.
    #[inline(always)]
    pub(super) fn ordered(hi: f64, lo: f64) -> Self {
        let (hi, lo) = fast_two_sum(hi, lo);
        dd(hi, lo)
    }

    /// x·2ᵏ, rounded only where the result is subnormal; overflow gives an infinity.
    pub(super) fn scale(self, k: i32) -> Self {
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

    /// Whether the sign bit is set.
    #[inline(always)]
    pub const fn is_sign_negative(self) -> bool {
        self.hi.is_sign_negative()
    }

    /// 1 with the sign of the number; NaN of NaN.
    pub fn signum(self) -> Self {
        Self::from(self.hi.signum())
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
