//! The published constants of `DoubleDouble`, recomputed at 400 bits.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::common::{RM, big, consts, double};
use astro_float::BigFloat;
use equip_scalar::DoubleDouble;

const BITS: usize = 400;

#[test]
fn constants_are_the_nearest_pairs() {
    let mut c = consts();
    let n = |x: f64| BigFloat::from_f64(x, 64);
    let quotient = |a: &BigFloat, b: &BigFloat| a.div(b, BITS, RM);
    let (pi, e) = (c.pi(BITS, RM), c.e(BITS, RM));
    let (ln_2, ln_10) = (c.ln_2(BITS, RM), c.ln_10(BITS, RM));
    let table = [
        (DoubleDouble::PI, pi.clone()),
        (DoubleDouble::TAU, pi.mul(&n(2.0), BITS, RM)),
        (DoubleDouble::FRAC_PI_2, quotient(&pi, &n(2.0))),
        (DoubleDouble::FRAC_PI_3, quotient(&pi, &n(3.0))),
        (DoubleDouble::FRAC_PI_4, quotient(&pi, &n(4.0))),
        (DoubleDouble::FRAC_PI_6, quotient(&pi, &n(6.0))),
        (DoubleDouble::FRAC_PI_8, quotient(&pi, &n(8.0))),
        (DoubleDouble::FRAC_1_PI, quotient(&n(1.0), &pi)),
        (DoubleDouble::FRAC_2_PI, quotient(&n(2.0), &pi)),
        (
            DoubleDouble::FRAC_2_SQRT_PI,
            quotient(&n(2.0), &pi.sqrt(BITS, RM)),
        ),
        (DoubleDouble::FRAC_1_SQRT_2, n(0.5).sqrt(BITS, RM)),
        (DoubleDouble::SQRT_2, n(2.0).sqrt(BITS, RM)),
        (DoubleDouble::E, e),
        (DoubleDouble::LN_2, ln_2.clone()),
        (DoubleDouble::LN_10, ln_10.clone()),
        (DoubleDouble::LOG2_E, quotient(&n(1.0), &ln_2)),
        (DoubleDouble::LOG10_E, quotient(&n(1.0), &ln_10)),
        (DoubleDouble::LOG10_2, quotient(&ln_2, &ln_10)),
        (DoubleDouble::LOG2_10, quotient(&ln_10, &ln_2)),
        (DoubleDouble::THIRD, quotient(&n(1.0), &n(3.0))),
    ];
    for (constant, exact) in table {
        let distance = double(&exact.sub(&big(constant), BITS, RM)).abs();
        assert!(
            distance <= constant.lo().abs() * f64::EPSILON / 2.0,
            "{constant:?}"
        );
        assert!(
            constant.lo().abs() <= constant.hi().abs() * f64::EPSILON / 2.0,
            "{constant:?}"
        );
    }
}

#[test]
fn limits() {
    assert_eq!(DoubleDouble::EPSILON.hi(), 2f64.powi(-104));
    assert_eq!(DoubleDouble::MIN_POSITIVE.hi(), 2f64.powi(-969));
    let next = DoubleDouble::MAX.lo().next_up();
    assert_eq!(f64::MAX + DoubleDouble::MAX.lo(), f64::MAX);
    assert_eq!(f64::MAX + next, f64::INFINITY);
}
