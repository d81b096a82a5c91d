//! x modulo π/2.
//!
//! Up to 2³⁰ with π/2 in three doubles [Cody–Waite; QD]; beyond, and where that subtraction cancels too much,
//! by exact integers: x·2/π with 2/π to 1280 bits [Payne–Hanek 1983]. The fraction then is right to 2⁻²⁵⁰ for
//! every finite x, while no double-double lies closer than about 2⁻¹²⁵ to a multiple of π/2: sin, cos and tan
//! keep their relative precision everywhere. The long way costs some microseconds.

use super::tables::TWO_OVER_PI;
use crate::double_double::integers::{integer, to_words, unit};
use crate::double_double::number::{DoubleDouble, dd};
use crate::double_double::transforms::{nearest, power_of_two, two_prod, two_sum};
use num_bigint::{BigInt, Sign};
use num_traits::ToPrimitive;

const PI_2: [f64; 3] = [
    std::f64::consts::FRAC_PI_2,
    6.123233995736766e-17,
    -1.4973849048591698e-33,
];

/// (n mod 4, r) with x = n·π/2 + r, |r| ≤ π/4, for finite x.
#[inline(always)]
pub(super) fn reduce(x: DoubleDouble) -> (u32, DoubleDouble) {
    if x.hi.abs() <= std::f64::consts::FRAC_PI_4 {
        return (0, x);
    }
    if x.hi.abs() < power_of_two(30) {
        let n = nearest(x.hi * std::f64::consts::FRAC_2_PI);
        let (p1, e1) = two_prod(n, PI_2[0]);
        let (p2, e2) = two_prod(n, PI_2[1]);
        // The first difference is exact [Sterbenz]; each further sum is relative to r unless r is far below
        // it.
        let (s, t) = two_sum(x.hi - p1, -e1);
        let r = dd(s, t)
            .plus_double(x.lo)
            .plus(-dd(p2, e2))
            .plus_double(-n * PI_2[2]);
        if r.hi.abs() > n.abs() * power_of_two(-48) {
            return (n as i64 as u32 & 3, r);
        }
    }
    reduce_exactly(x)
}

#[cold]
fn reduce_exactly(x: DoubleDouble) -> (u32, DoubleDouble) {
    let (quadrant, [hi, lo]) = turns(&x.array());
    (quadrant, dd(hi, lo).times(DoubleDouble::FRAC_PI_2))
}

/// (n mod 4, f) with x = (n + f)·π/2, |f| ≤ 1/2, for a finite sum x of doubles, largest first.
pub(crate) fn turns<const N: usize>(x: &[f64]) -> (u32, [f64; N]) {
    let unit = unit(x);
    let product = integer(x, unit) * BigInt::from_slice(Sign::Plus, &TWO_OVER_PI);
    let point = 1280 - unit; // bits behind the binary point; unit ≤ 1023
    let half = BigInt::from(1) << (point - 1);
    let n: BigInt = (&product + half) >> point;
    let fraction = product - (&n << point);
    let quadrant = (n & BigInt::from(3)).to_u32().unwrap_or(0);
    (quadrant, to_words(fraction, -point))
}
