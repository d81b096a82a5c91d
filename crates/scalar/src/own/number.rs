//! [`Own`] as a number: arithmetic and comparison, signs, rounding, integers, text.

use super::{Arithmetic, Own};
use crate::double_double::integers::remainder;
use crate::double_double::text::parse::Decimal;
use crate::traits::Float;
use std::cmp::Ordering;
use std::fmt;
use std::num::FpCategory;
use std::ops::{Add, Div, Mul, Neg, Rem, Sub};

impl<A: Arithmetic> Clone for Own<A> {
    #[inline(always)]
    fn clone(&self) -> Self {
        *self
    }
}

impl<A: Arithmetic> Copy for Own<A> {}

impl<A: Arithmetic> PartialEq for Own<A> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        self.0 == other.0
    }
}

impl<A: Arithmetic> PartialOrd for Own<A> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.0.partial_cmp(&other.0)
    }
}

macro_rules! operators {
    ($($op:ident $f:ident |$x:ident, $y:ident| $value:expr;)*) => {$(
        impl<A: Arithmetic> $op for Own<A> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, other: Self) -> Self {
                let ($x, $y) = (self.0, other.0);
                Own($value)
            }
        }
    )*};
}
operators! {
    Add add |x, y| x + y;
    Sub sub |x, y| x - y;
    Mul mul |x, y| x * y;
    Div div |x, y| A::over(x, y);
}

impl<A: Arithmetic> Neg for Own<A> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Own(-self.0)
    }
}

impl<A: Arithmetic> Rem for Own<A> {
    type Output = Self;
    /// Exact in the range of doubles.
    fn rem(self, other: Self) -> Self {
        let special = self.hi() % other.hi();
        if special.is_nan() || self.hi() == 0.0 || other.hi().is_infinite() {
            return if special.is_nan() { Self::NAN } else { self };
        }
        let rest = remainder(&self.expansion(), &other.expansion());
        Self::from_expansion(rest).abs().copysign(self)
    }
}

impl<A: Arithmetic> From<f64> for Own<A> {
    #[inline(always)]
    fn from(x: f64) -> Self {
        Self::small(x)
    }
}

/// The functions of `f64` under its names.
macro_rules! inherent {
    ($($f:ident),*; $($g:ident),*) => {
        impl<A: Arithmetic> Own<A> {
            $(
                #[doc = concat!("As [`Arithmetic::", stringify!($f), "`].")]
                #[inline(always)]
                pub fn $f(self) -> Self {
                    Own(A::$f(self.0))
                }
            )*
            $(
                #[doc = concat!("As [`Arithmetic::", stringify!($g), "`].")]
                #[inline(always)]
                pub fn $g(self, other: Self) -> Self {
                    Own(A::$g(self.0, other.0))
                }
            )*
        }
    };
}
inherent!(
    sqrt, cbrt, exp, exp2, exp_m1, ln, ln_1p, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh,
    asinh, acosh, atanh, erf, erfc; powf, atan2, hypot
);

/// What is left of the functions of `f64`, as nalgebra and num-traits ask for them.
impl<A: Arithmetic> Own<A> {
    pub(crate) const EPSILON: Self = Own(A::EPSILON);
    pub(crate) const MAX: Self = Own(A::MAX);
    pub(crate) const MIN_POSITIVE: Self = Own(A::MIN_POSITIVE);
    pub(crate) const INFINITY: Self = Own(A::INFINITY);
    pub(crate) const NAN: Self = Own(A::NAN);

    #[inline(always)]
    pub(crate) fn small(x: f64) -> Self {
        Own(A::from_f64(x))
    }

    #[inline(always)]
    pub(crate) fn hi(self) -> f64 {
        A::to_f64(self.0)
    }

    #[inline(always)]
    pub(crate) fn powi(self, n: i32) -> Self {
        Own(A::powi(self.0, n))
    }

    pub(crate) fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }

    pub(crate) fn log2(self) -> Self {
        self.log(Self::small(2.0))
    }

    pub(crate) fn log10(self) -> Self {
        self.log(Self::small(10.0))
    }

    #[inline(always)]
    pub(crate) fn is_nan(self) -> bool {
        self.0.partial_cmp(&self.0).is_none()
    }

    #[inline(always)]
    pub(crate) fn is_finite(self) -> bool {
        let zero = Self::small(0.0);
        self * zero == zero
    }

    pub(crate) fn is_infinite(self) -> bool {
        !self.is_finite() && !self.is_nan()
    }

    pub(crate) fn classify(self) -> FpCategory {
        if self.is_finite() && self != Self::small(0.0) && self.abs() >= Self::MIN_POSITIVE {
            FpCategory::Normal
        } else {
            self.hi().classify()
        }
    }

    #[inline(always)]
    pub(crate) fn is_sign_negative(self) -> bool {
        self < Self::small(0.0) || self.hi().is_sign_negative()
    }

    pub(crate) fn signum(self) -> Self {
        match self.is_nan() {
            true => self,
            false => Self::small(1.0).copysign(self),
        }
    }

    /// Word by word, up to the first that is not whole.
    pub(crate) fn floor(self) -> Self {
        let mut words = self.expansion();
        if !words[0].is_finite() {
            return self;
        }
        if let Some(first) = words.iter().position(|word| *word != word.floor()) {
            words[first] = words[first].floor();
            words[first + 1..].fill(0.0);
        }
        Self::from_expansion(words)
    }

    pub(crate) fn from_i64(n: i64) -> Self {
        Self::from_i128(n.into())
    }

    pub(crate) fn from_u64(n: u64) -> Self {
        Self::from_i128(n.into())
    }

    pub(crate) fn from_i128(n: i128) -> Self {
        let size = Self::from_u128(n.unsigned_abs());
        if n < 0 { -size } else { size }
    }

    /// From words of 32 bits, the lowest first.
    pub(crate) fn from_u128(n: u128) -> Self {
        let words = [0, 32, 64, 96].map(|shift| (n >> shift) as u32);
        let mut unit = 1.0;
        words.iter().fold(Self::small(0.0), |sum, &word| {
            let term = Self::small(f64::from(word) * unit);
            unit *= 4_294_967_296.0;
            sum + term
        })
    }

    /// The integer part, where it fits.
    pub(crate) fn to_i128(self) -> Option<i128> {
        let whole = self.trunc();
        let fits = whole.hi().abs() < i128::MAX as f64;
        fits.then(|| whole.expansion().iter().map(|&word| word as i128).sum())
    }

    pub(crate) fn to_u128(self) -> Option<u128> {
        u128::try_from(self.to_i128()?).ok()
    }

    pub(crate) fn nearest(decimal: &Decimal) -> Self {
        Self::from_expansion(decimal.to_words())
    }

    /// Digits of which a decimal always has as many: those that two numbers never share.
    pub(crate) fn digits() -> i64 {
        (f64::from(A::MANTISSA_BITS - 1) * std::f64::consts::LOG10_2) as i64
    }
}

impl<A: Arithmetic> fmt::Debug for Own<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
