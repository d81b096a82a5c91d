//! Natural numbers of any length, with the operations for exact printing, parsing and argument reduction.
//!
//! Schoolbook arithmetic on 32-bit limbs, least significant first [Knuth, TAOCP 2, 4.3.1]. The longest
//! numbers that occur have about 8000 bits.

use super::number::DoubleDouble;
use super::transforms::{exponent, power_of_two};
use std::cmp::Ordering;

/// A natural number; the last limb is not zero.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Natural(Vec<u32>);

/// |x| = integer · 2^exponent of a finite double.
fn decode(x: f64) -> (u64, i32) {
    let bits = x.to_bits();
    let biased = (bits >> 52) as i32 & 0x7ff;
    let fraction = bits & ((1 << 52) - 1);
    if biased == 0 {
        (fraction, -1074)
    } else {
        (fraction | 1 << 52, biased - 1075)
    }
}

impl Natural {
    pub(super) fn from_limbs(limbs: &[u32]) -> Self {
        Natural(limbs.to_vec()).trimmed()
    }

    pub(crate) fn from_u64(n: u64) -> Self {
        Self::from_limbs(&[n as u32, (n >> 32) as u32])
    }

    fn trimmed(mut self) -> Self {
        while self.0.last() == Some(&0) {
            self.0.pop();
        }
        self
    }

    pub(super) fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Sets bit 0.
    pub(super) fn set_low_bit(&mut self) {
        match self.0.first_mut() {
            Some(limb) => *limb |= 1,
            None => self.0.push(1),
        }
    }

    pub(super) fn bits(&self) -> usize {
        self.0
            .last()
            .map_or(0, |top| 32 * self.0.len() - top.leading_zeros() as usize)
    }

    pub(super) fn bit(&self, i: usize) -> bool {
        self.0
            .get(i / 32)
            .is_some_and(|limb| limb >> (i % 32) & 1 == 1)
    }

    /// Whether a bit below number `i` is set.
    fn any_below(&self, i: usize) -> bool {
        let whole = (i / 32).min(self.0.len());
        self.0[..whole].iter().any(|&limb| limb != 0)
            || self
                .0
                .get(i / 32)
                .is_some_and(|limb| limb & ((1 << (i % 32)) - 1) != 0)
    }

    pub(super) fn shifted_left(&self, k: usize) -> Self {
        let mut limbs = vec![0; k / 32];
        let shift = k % 32;
        let mut carry = 0;
        for &limb in &self.0 {
            let wide = u64::from(limb) << shift | carry;
            limbs.push(wide as u32);
            carry = wide >> 32;
        }
        limbs.push(carry as u32);
        Natural(limbs).trimmed()
    }

    pub(super) fn shifted_right(&self, k: usize) -> Self {
        let shift = k % 32;
        let limb = |i: usize| u64::from(self.0.get(i).copied().unwrap_or(0));
        let limbs = (k / 32..self.0.len()).map(|i| ((limb(i + 1) << 32 | limb(i)) >> shift) as u32);
        Natural(limbs.collect()).trimmed()
    }

    /// The number modulo 2ᵏ.
    pub(super) fn low_bits(&self, k: usize) -> Self {
        let mut limbs = self.0.clone();
        limbs.truncate(k.div_ceil(32));
        if !k.is_multiple_of(32) && limbs.len() == k.div_ceil(32) {
            limbs[k / 32] &= (1 << (k % 32)) - 1;
        }
        Natural(limbs).trimmed()
    }

    pub(super) fn times_small(&mut self, factor: u32, addend: u32) {
        let mut carry = u64::from(addend);
        for limb in &mut self.0 {
            let wide = u64::from(*limb) * u64::from(factor) + carry;
            *limb = wide as u32;
            carry = wide >> 32;
        }
        if carry != 0 {
            self.0.push(carry as u32);
        }
    }

    /// Divides in place and returns the remainder.
    pub(super) fn divide_small(&mut self, divisor: u32) -> u32 {
        let mut rest = 0;
        for limb in self.0.iter_mut().rev() {
            let wide = rest << 32 | u64::from(*limb);
            *limb = (wide / u64::from(divisor)) as u32;
            rest = wide % u64::from(divisor);
        }
        while self.0.last() == Some(&0) {
            self.0.pop();
        }
        rest as u32
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut limbs = vec![0u32; self.0.len() + other.0.len()];
        for (i, &a) in self.0.iter().enumerate() {
            let mut carry = 0;
            for (j, &b) in other.0.iter().enumerate() {
                let wide = u64::from(a) * u64::from(b) + u64::from(limbs[i + j]) + carry;
                limbs[i + j] = wide as u32;
                carry = wide >> 32;
            }
            limbs[i + other.0.len()] = carry as u32;
        }
        Natural(limbs).trimmed()
    }

    fn plus(&self, other: &Self) -> Self {
        let mut carry = 0;
        let mut limbs: Vec<u32> = Vec::with_capacity(self.0.len().max(other.0.len()) + 1);
        for i in 0..self.0.len().max(other.0.len()) {
            let limb = |n: &Self| u64::from(n.0.get(i).copied().unwrap_or(0));
            let wide = limb(self) + limb(other) + carry;
            limbs.push(wide as u32);
            carry = wide >> 32;
        }
        limbs.push(carry as u32);
        Natural(limbs).trimmed()
    }

    /// |self − other|.
    pub(super) fn distance(&self, other: &Self) -> Self {
        let (large, small) = if *self >= *other {
            (self, other)
        } else {
            (other, self)
        };
        let mut limbs = large.0.clone();
        let mut borrow = false;
        for (i, limb) in limbs.iter_mut().enumerate() {
            let (partial, first) = limb.overflowing_sub(small.0.get(i).copied().unwrap_or(0));
            let (full, second) = partial.overflowing_sub(u32::from(borrow));
            *limb = full;
            borrow = first || second;
        }
        Natural(limbs).trimmed()
    }

    /// The remainder modulo `divisor` ≠ 0, in place, one bit of the quotient at a time.
    pub(super) fn reduce(&mut self, divisor: &Self) {
        while *self >= *divisor {
            let shift = self.bits() - divisor.bits();
            let step = divisor.shifted_left(shift);
            let step = if step > *self {
                divisor.shifted_left(shift - 1)
            } else {
                step
            };
            *self = self.distance(&step);
        }
    }

    /// self · 2^exponent rounded to the nearest double, ties to even.
    fn to_double(&self, exponent: i32) -> f64 {
        let bits = self.bits() as i32;
        let top = bits - 1 + exponent;
        if bits == 0 || top < -1075 {
            return 0.0;
        }
        if top > 1023 {
            return f64::INFINITY;
        }
        let dropped = (bits - 53).max(-1074 - exponent).max(0) as usize;
        let mut kept = self.shifted_right(dropped).low_u64();
        let half = dropped > 0 && self.bit(dropped - 1);
        if half && (kept & 1 == 1 || self.any_below(dropped - 1)) {
            kept += 1;
        }
        let scale = exponent + dropped as i32;
        if scale >= -1000 {
            kept as f64 * power_of_two(scale)
        } else {
            kept as f64 * power_of_two(-600) * power_of_two(scale + 600)
        }
    }

    fn low_u64(&self) -> u64 {
        let limb = |i: usize| u64::from(self.0.get(i).copied().unwrap_or(0));
        limb(1) << 32 | limb(0)
    }

    /// self · 2^exponent as a sum of doubles, each of them nearest to what is left by those before it.
    pub(crate) fn to_words<const N: usize>(&self, exponent: i32) -> [f64; N] {
        let mut words = [0.0; N];
        let (mut rest, mut negative) = (self.clone(), false);
        for word in &mut words {
            let x = rest.to_double(exponent);
            *word = if negative { -x } else { x };
            let (integer, scale) = decode(x);
            if !x.is_finite() || scale < exponent {
                break;
            }
            let head = Natural::from_u64(integer).shifted_left((scale - exponent) as usize);
            negative ^= rest < head;
            rest = rest.distance(&head);
        }
        words
    }

    /// |x| / 2^unit, where 2^unit divides all words that x is the sum of, largest first.
    pub(crate) fn of_magnitude(x: &[f64], unit: i32) -> Self {
        let part = |x: f64| {
            let (integer, scale) = decode(x);
            // Trailing zeros make up for a scale below the unit.
            if scale >= unit {
                Natural::from_u64(integer).shifted_left((scale - unit) as usize)
            } else {
                Natural::from_u64(integer).shifted_right((unit - scale) as usize)
            }
        };
        x[1..].iter().fold(part(x[0]), |sum, &word| {
            if word.is_sign_negative() == x[0].is_sign_negative() {
                sum.plus(&part(word))
            } else {
                sum.distance(&part(word))
            }
        })
    }
}

impl PartialOrd for Natural {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Natural {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0
            .len()
            .cmp(&other.0.len())
            .then_with(|| self.0.iter().rev().cmp(other.0.iter().rev()))
    }
}

/// The largest k such that 2ᵏ divides all words of a finite number; 0 for zero.
pub(crate) fn unit(x: &[f64]) -> i32 {
    let units = x.iter().filter(|&&x| x != 0.0).map(|&x| {
        let (integer, scale) = decode(x);
        scale + integer.trailing_zeros() as i32
    });
    units.min().unwrap_or(0)
}

/// The remainder of truncated division of |x| by |y| ≠ 0, by long division of integers.
pub(crate) fn remainder<const N: usize>(x: &[f64], y: &[f64]) -> [f64; N] {
    let unit = unit(x).min(unit(y));
    let mut rest = Natural::of_magnitude(x, unit);
    rest.reduce(&Natural::of_magnitude(y, unit));
    rest.to_words(unit)
}

impl DoubleDouble {
    /// The words, largest first.
    pub(super) fn array(self) -> [f64; 2] {
        [self.hi, self.lo]
    }

    /// ⌊log₂|x|⌋ of the upper part.
    pub(super) fn exponent(self) -> i32 {
        exponent(self.hi)
    }
}
