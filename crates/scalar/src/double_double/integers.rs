//! Sums of doubles as integers times a power of two, to print, parse and reduce them exactly.
//!
//! The longest integers that occur have about 8000 bits.

use num_bigint::{BigInt, BigUint};
use num_traits::{Float, Signed};

/// The largest k such that 2ᵏ divides all words of a finite number; 0 for zero.
pub(crate) fn unit(x: &[f64]) -> i32 {
    let units = x.iter().filter(|&&x| x != 0.0).map(|&x| {
        let (size, scale, _) = Float::integer_decode(x);
        i32::from(scale) + size.trailing_zeros() as i32
    });
    units.min().unwrap_or(0)
}

/// x / 2^unit, where 2^unit divides all words that x is the sum of.
pub(crate) fn integer(x: &[f64], unit: i32) -> BigInt {
    let words = x.iter().map(|&x| {
        let (size, scale, sign) = Float::integer_decode(x);
        let word = BigInt::from(size) * sign;
        // Trailing zeros make up for a scale below the unit.
        match i32::from(scale) - unit {
            up @ 0.. => word << up,
            down => word >> -down,
        }
    });
    words.sum()
}

/// n·2^exponent as a sum of doubles, each of them nearest to what is left by those before it.
pub(crate) fn to_words<const N: usize>(mut n: BigInt, exponent: i32) -> [f64; N] {
    let mut words = [0.0; N];
    for word in &mut words {
        let size = nearest(n.magnitude(), exponent);
        *word = if n.is_negative() { -size } else { size };
        if !size.is_finite() {
            break;
        }
        n -= integer(&[*word], exponent);
    }
    words
}

/// n·2^exponent rounded to the nearest double, ties to even.
fn nearest(n: &BigUint, exponent: i32) -> f64 {
    // Bits beyond the 53rd, and below the smallest double 2⁻¹⁰⁷⁴.
    let dropped = (n.bits() as i32 - 53).max(-1074 - exponent).max(0);
    let mut kept = (n >> dropped).iter_u64_digits().next().unwrap_or(0);
    if dropped > 0 {
        let half = dropped as u64 - 1;
        let is_above_half = n.trailing_zeros() < Some(half);
        if n.bit(half) && (kept & 1 == 1 || is_above_half) {
            kept += 1;
        }
    }
    libm::ldexp(kept as f64, exponent + dropped)
}

/// The remainder of truncated division of |x| by |y| ≠ 0.
pub(crate) fn remainder<const N: usize>(x: &[f64], y: &[f64]) -> [f64; N] {
    let unit = unit(x).min(unit(y));
    let [x, y] = [x, y].map(|words| integer(words, unit).abs());
    to_words(x % y, unit)
}
