//! + − × ÷ and the remainder.
//!
//! Each operator runs the published algorithm and then tests the lower part of the result. It is NaN exactly
//! if an infinity, a NaN or an overflow occurred (including an overflow in Dekker's splitting, above 2⁹⁹⁶). A
//! separate branch handles these cases. The algorithms lose the sign of a zero; it is restored from the
//! leading operation.

use super::integers::remainder;
use super::number::{DoubleDouble, dd};
use super::transforms::{SAFE_MIN, exponent, two_sum};
use super::words;
use std::ops::{Add, Div, Mul, Neg, Rem, Sub};

/// Operations without a look at special values, for use inside this module tree.
impl DoubleDouble {
    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        Self::of(words::plus(self.words(), other.words()))
    }

    /// JMP algorithm 4, error below 2u².
    #[inline(always)]
    pub(super) fn plus_double(self, other: f64) -> Self {
        let (sh, sl) = two_sum(self.hi, other);
        Self::ordered(sh, self.lo + sl)
    }

    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        Self::of(words::times(self.words(), other.words()))
    }

    #[inline(always)]
    pub(super) fn times_double(self, other: f64) -> Self {
        Self::of(words::times_word(self.words(), other))
    }

    #[inline(always)]
    pub(super) fn over(self, other: Self) -> Self {
        Self::of(words::over(self.words(), other.words()))
    }

    /// Half and double are exact but for subnormal numbers and overflow.
    #[inline(always)]
    pub(super) fn half(self) -> Self {
        dd(0.5 * self.hi, 0.5 * self.lo)
    }
}

#[cold]
fn add_special(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let sum = a.hi + b.hi;
    if !sum.is_finite() {
        return sum.into();
    }
    dd(0.25 * a.hi, 0.25 * a.lo)
        .plus(dd(0.25 * b.hi, 0.25 * b.lo))
        .scale(2)
}

#[cold]
fn mul_special(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let product = a.hi * b.hi;
    if !product.is_finite() {
        return product.into();
    }
    let (large, small) = if a.hi.abs() > b.hi.abs() {
        (a, b)
    } else {
        (b, a)
    };
    large.scale(-128).times(small).scale(128)
}

#[cold]
fn div_special(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let quotient = a.hi / b.hi;
    let ordinary = |x: f64| x.is_finite() && x != 0.0;
    if quotient.is_nan() || !ordinary(a.hi) || !ordinary(b.hi) {
        return quotient.into();
    }
    let (i, k) = (exponent(a.hi), exponent(b.hi));
    a.scale(-i).over(b.scale(-k)).scale(i - k)
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let sum = self.plus(other);
        if sum.lo.is_nan() {
            add_special(self, other)
        } else {
            sum
        }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + (-other)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        dd(-self.hi, -self.lo)
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = self.times(other);
        if product.lo.is_nan() {
            mul_special(self, other)
        } else {
            product
        }
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.over(other);
        if quotient.lo.is_nan() || self.hi.abs() < SAFE_MIN {
            div_special(self, other)
        } else {
            quotient
        }
    }
}

impl Rem for DoubleDouble {
    type Output = Self;
    /// The remainder of truncated division, with the sign of the dividend: exact wherever it fits two
    /// doubles, by long division of integers (slow).
    fn rem(self, other: Self) -> Self {
        let special = self.hi % other.hi;
        if self.hi == 0.0 || special.is_nan() || other.is_infinite() {
            return if special.is_nan() {
                special.into()
            } else {
                self
            };
        }
        let [hi, lo] = remainder(&self.array(), &other.array());
        dd(hi, lo).copysign(self)
    }
}
