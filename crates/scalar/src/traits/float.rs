//! [`Float`]: the floating-point types of the integrator.

use super::derivatives::FirstOrder;
use super::pack::Pack;
use super::scalar::Scalar;
use crate::constant::{Constant, Words, Written};
use crate::error::ParseFloatError;
use nalgebra::RealField;
use std::fmt::{Display, LowerExp};

/// A [`Scalar`] with ordering, ε, exact integer ratios, parsed decimals and dense linear algebra.
///
/// Elementary functions are methods (`x.sqrt()`) through the supertrait [`RealField`]; the names below are
/// chosen not to collide with it.
pub trait Float: Scalar + RealField + Copy + Display + LowerExp {
    /// Name for people and files: `f64`, `dd`.
    const NAME: &'static str;
    /// Bits of the significand.
    const MANTISSA_BITS: u32;
    /// Decimal digits that print and parse back to the same number. Of the numbers of double-double only
    /// those that have no gap between the two parts need this few; `Display` without a precision finds the
    /// digits a number needs.
    const ROUND_TRIP_DIGITS: usize;
    /// The unit in which relative errors of arithmetic are counted. For `f64` 2⁻⁵², 2^(1 −
    /// [`MANTISSA_BITS`](Self::MANTISSA_BITS)). For double-double 2⁻¹⁰⁴, twice that, because its arithmetic
    /// rounds to that only (sums within 0.75, products within 1.25 of it).
    const EPSILON: Self;
    /// Largest finite number.
    const MAX: Self;
    /// Smallest positive number at which full relative precision is still reached.
    const MIN_POSITIVE: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// Not a number.
    const NAN: Self;

    /// Whether this is `f64`, so that [`as_doubles`](Self::as_doubles) gives the numbers: where code for the
    /// one or the other need not be compiled.
    const IS_DOUBLE: bool = false;
    /// Whether this is [`DoubleDouble`](crate::DoubleDouble).
    const IS_DOUBLE_DOUBLE: bool = false;
    /// How many numbers are best worked on together: 8, or 1 where there are no vectors.
    const WIDTH: usize;
    /// `N` numbers that undergo the same operations.
    type Pack<const N: usize>: Pack<Self, N>;
    /// Dual number with `N` first derivatives over this type.
    type Forward<const N: usize>: FirstOrder<Self, N>;

    /// The value of the given `f64`, exactly. A literal such as `0.1` stays the *double* 0.1:
    /// use [`ratio`](Self::ratio) or [`decimal`](Self::decimal) for 1/10.
    fn exact(x: f64) -> Self;
    /// An integer, exactly as far as the significand reaches.
    fn int(n: i64) -> Self;
    /// n/d, correctly rounded or nearly so.
    fn ratio(n: i64, d: i64) -> Self {
        Self::int(n) / Self::int(d)
    }
    /// A decimal such as `"0.012277471"`, read in this type's precision.
    ///
    /// # Errors
    /// [`ParseFloatError`] when the text is not a decimal number.
    fn decimal(text: &str) -> Result<Self, ParseFloatError>;
    /// The nearest `f64`.
    fn to_f64(self) -> f64;
    /// The number as an unevaluated sum of doubles, largest first: exact up to 318 bits, as far as it lies in
    /// the range of doubles. Checkpoints and constants hold these.
    fn expansion(self) -> Words;
    /// The sum of an expansion made by [`expansion`](Self::expansion).
    fn from_expansion(parts: Words) -> Self {
        parts
            .iter()
            .rev()
            .fold(Self::int(0), |sum, &part| sum + Self::exact(part))
    }
    /// The slice as doubles, if this type is `f64`: how generic code reaches what is computed in
    /// [`Lanes`](crate::Lanes).
    #[inline(always)]
    fn as_doubles(_: &[Self]) -> Option<&[f64]> {
        None
    }
    /// As [`as_doubles`](Self::as_doubles), to be written to.
    #[inline(always)]
    fn as_doubles_mut(_: &mut [Self]) -> Option<&mut [f64]> {
        None
    }
    /// Whether the number is NaN.
    fn is_nan(self) -> bool {
        self.partial_cmp(&self).is_none()
    }
    /// (a + b rounded, the part lost): Knuth's two-sum, [Møller 1965; Knuth, TAOCP 2, 4.2.2], six additions.
    fn two_sum(a: Self, b: Self) -> (Self, Self) {
        let sum = a + b;
        let b_part = sum - a;
        (sum, (a - (sum - b_part)) + (b - b_part))
    }
}

/// Largest |n| of x^(n/2): beyond, rounding adds up, and exp(c ln x) is as good.
const LARGEST: i32 = 15;

impl Constant {
    /// The odd n for which it is n/2 in the floating-point type `T`, with |n| ≤ 15.
    #[inline(always)]
    pub(crate) fn halves<T: Float>(self) -> Option<i32> {
        let double = self.to_double();
        let n = (2.0 * double) as i32;
        let is_half = n & 1 == 1 && n.abs() <= LARGEST && f64::from(n) == 2.0 * double;
        (is_half && (T::IS_DOUBLE || self.to::<T>() == T::exact(double))).then_some(n)
    }

    /// The odd n with |n| ≤ 15 for which the constant is n/2 in every floating-point type.
    #[doc(hidden)]
    pub fn exact_halves(self) -> Option<i32> {
        let n = self.halves::<f64>()?;
        let is_exact = match self.written() {
            Written::Double(_) => true,
            Written::Ratio(above, below) => {
                2 * i128::from(above) == i128::from(n) * i128::from(below)
            }
            Written::Extended(parts) => parts[1..].iter().all(|&part| part == 0.0),
            Written::Decimal(_) => false,
        };
        is_exact.then_some(n)
    }
}

impl Constant {
    /// The constant in the floating-point type `T`.
    #[inline(always)]
    pub fn to<T: Float>(self) -> T {
        if T::IS_DOUBLE {
            return T::exact(self.double);
        }
        match self.written {
            Written::Double(x) => T::exact(x),
            Written::Ratio(n, d) => T::ratio(n, d),
            Written::Decimal(text) => T::decimal(text).unwrap_or(T::NAN),
            Written::Extended(parts) => T::from_expansion(parts),
        }
    }
}

/// What [`Scalar`](crate::Scalar) asks of every float alike, inside its impl.
macro_rules! scalar_glue {
    (; $($f:ident),*) => {$(
        #[inline(always)]
        fn $f(x: Self) -> Self {
            Self::$f(x)
        }
    )*};
    () => {
        #[inline(always)]
        fn constant(c: $crate::Constant) -> Self {
            c.to()
        }
        #[inline(always)]
        fn powi(x: Self, n: i32) -> Self {
            Self::powi(x, n)
        }
        #[inline(always)]
        fn powf(x: Self, c: $crate::Constant) -> Self {
            match c.halves::<Self>() {
                Some(n) => $crate::traits::half_power::half_power(x, n),
                None => Self::powf(x, c.to()),
            }
        }
        #[inline(always)]
        fn pow(x: Self, y: Self) -> Self {
            Self::powf(x, y)
        }
        #[inline(always)]
        fn atan2(y: Self, x: Self) -> Self {
            Self::atan2(y, x)
        }
        #[inline(always)]
        fn hypot(x: Self, y: Self) -> Self {
            Self::hypot(x, y)
        }
        #[inline(always)]
        fn min(x: Self, y: Self) -> Self {
            Self::min(x, y)
        }
        #[inline(always)]
        fn max(x: Self, y: Self) -> Self {
            Self::max(x, y)
        }
        #[inline(always)]
        fn signum(x: Self) -> Self {
            let zero = <Self as $crate::Float>::int(0);
            if x > zero {
                <Self as $crate::Float>::int(1)
            } else if x < zero {
                <Self as $crate::Float>::int(-1)
            } else {
                x
            }
        }
        #[inline(always)]
        fn at_most(x: Self, y: Self) -> Self {
            if x <= y {
                <Self as $crate::Float>::int(1)
            } else {
                <Self as $crate::Float>::int(0)
            }
        }
        #[inline(always)]
        fn where_nonzero(x: Self, test: Self) -> Self {
            let zero = <Self as $crate::Float>::int(0);
            if test == zero { zero } else { x }
        }
        #[inline(always)]
        fn powf_derivative(x: Self, power: Self, c: $crate::Constant) -> Self {
            if let Some(n) = c.halves::<Self>() {
                return $crate::traits::half_power::half_power_derivative(x, power, n);
            }
            let (zero, c) = (<Self as $crate::Float>::int(0), c.to::<Self>());
            if power != zero && Self::is_finite(power) {
                c * power / x
            } else if c == zero {
                c
            } else {
                c * Self::powf(x, c - <Self as $crate::Float>::int(1))
            }
        }
        $crate::traits::scalar_glue!(;
            recip, sqrt, cbrt, exp, exp2, ln, exp_m1, ln_1p, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh,
            asinh, abs
        );
    };
}
pub(crate) use scalar_glue;
