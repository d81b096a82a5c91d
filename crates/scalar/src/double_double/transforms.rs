//! Error-free transforms of two words, and exact powers of two.

use std::ops::{Add, Div, Mul, Sub};

/// Below this a quotient or a root is computed after scaling, because the product in it would be inexact.
pub(super) const SAFE_MIN: f64 = power_of_two(-900);

/// From here on s² might overflow.
pub(super) const SAFE_MAX: f64 = power_of_two(1000);

/// An `f64`, or one in each of several lanes: arithmetic, what a product is rounded by, and one selection.
pub(super) trait Word:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    fn word(x: f64) -> Self;
    /// RN(ab − p), p being RN(ab).
    fn product_rest(a: Self, b: Self, p: Self) -> Self;
    /// `self` where `test` is not zero, `other` where it is.
    fn unless_zero(self, test: Self, other: Self) -> Self;
}

impl Word for f64 {
    #[inline(always)]
    fn word(x: f64) -> f64 {
        x
    }

    /// Plain builds would have to call for it: by splitting it is the same for all but very small and very
    /// large numbers.
    #[inline(always)]
    fn product_rest(a: f64, b: f64, p: f64) -> f64 {
        let rest = rest_by_splitting(a, b, p);
        if p.abs() > SAFE_MIN && !rest.is_nan() {
            rest
        } else {
            fused(a, b, p)
        }
    }

    #[inline(always)]
    fn unless_zero(self, test: f64, other: f64) -> f64 {
        if test == 0.0 { other } else { self }
    }
}

#[cold]
#[inline(never)]
fn fused(a: f64, b: f64, p: f64) -> f64 {
    a.mul_add(b, -p)
}

/// a + b = s + e exactly, s = RN(a + b). [Møller 1965; Knuth, TAOCP 2, 4.2.2]
#[inline(always)]
pub(super) fn two_sum<W: Word>(a: W, b: W) -> (W, W) {
    let s = a + b;
    let b_part = s - a;
    (s, (a - (s - b_part)) + (b - b_part))
}

/// The same for |a| ≥ |b| or a = 0. [Dekker 1971]
#[inline(always)]
pub(super) fn fast_two_sum<W: Word>(a: W, b: W) -> (W, W) {
    let s = a + b;
    (s, b - (s - a))
}

/// a·b = p + e exactly, p = RN(ab), unless e is below the least number (then it is the nearest) or p is not
/// finite: e = RN(ab − p), one operation of processors that have it.
#[inline(always)]
pub(super) fn two_prod<W: Word>(a: W, b: W) -> (W, W) {
    let p = a * b;
    (p, W::product_rest(a, b, p))
}

/// The same e without that operation: a = high + low with at most 26 bits each. [Dekker 1971; Veltkamp]
/// Inexact where ab < 2⁻⁹⁶⁹, NaN where a factor is above 2⁹⁹⁶.
#[inline(always)]
pub(super) fn rest_by_splitting(a: f64, b: f64, p: f64) -> f64 {
    let split = |a: f64| {
        let t = 134_217_729.0 * a; // 2²⁷ + 1
        let high = t - (t - a);
        (high, a - high)
    };
    let ((ah, al), (bh, bl)) = (split(a), split(b));
    ((ah * bh - p) + ah * bl + al * bh) + al * bl
}

/// 2ᵏ for −1022 ≤ k ≤ 1023.
#[inline(always)]
pub(crate) const fn power_of_two(k: i32) -> f64 {
    debug_assert!(-1022 <= k && k <= 1023);
    f64::from_bits(((k + 1023) as u64) << 52)
}

/// ⌊log₂|x|⌋ for finite x ≠ 0, subnormal numbers included.
#[inline]
pub(super) fn exponent(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52) as i32 & 0x7ff;
    if biased != 0 {
        return biased - 1023;
    }
    let fraction = x.to_bits() & ((1 << 52) - 1);
    63 - fraction.leading_zeros() as i32 - 1074
}

/// The integer nearest to x, for |x| < 2⁵¹: additions only, because `f64::round` is a call on plain x86-64.
#[inline(always)]
pub(super) fn nearest(x: f64) -> f64 {
    const SHIFT: f64 = 6_755_399_441_055_744.0; // 1.5 · 2⁵²
    (x + SHIFT) - SHIFT
}
