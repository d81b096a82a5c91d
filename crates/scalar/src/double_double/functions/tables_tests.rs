//! The tables recomputed at 400 bits, and 2/π at 1500.
#![allow(clippy::unwrap_used)]

use super::*;
use astro_float::{BigFloat, Consts, RoundingMode};

const BITS: usize = 400;
const RM: RoundingMode = RoundingMode::ToEven;

fn number(x: f64) -> BigFloat {
    BigFloat::from_f64(x, 64)
}

/// Asserts that `parts` is the exact number rounded, the rest rounded, and so on.
fn assert_nearest(parts: &[f64], exact: &BigFloat, what: &str) {
    let mut rest = exact.clone();
    for &part in parts {
        rest = rest.sub(&number(part), BITS, RM);
        let half_ulp = number((part.abs().next_up() - part.abs()) / 2.0);
        assert!(rest.abs().cmp(&half_ulp) <= Some(0), "{what}: {part:e}");
    }
}

fn assert_pair(x: DoubleDouble, exact: &BigFloat, what: &str) {
    assert_nearest(&[x.hi, x.lo], exact, what);
}

#[test]
fn tables_hold_the_nearest_numbers() {
    let mut c = Consts::new().unwrap();
    let over_32 = |j: usize| number(j as f64 / 32.0);
    for (j, &(a, b, d)) in EXP2.iter().enumerate() {
        let exact = if j == 0 {
            number(1.0)
        } else {
            number(2.0).pow(&over_32(j), BITS, RM, &mut c)
        };
        assert_nearest(&[a, b, d], &exact, "EXP2");
    }
    for (i, &x) in LN.iter().enumerate() {
        let ratio = number(32.0).div(&number((i + 23) as f64), BITS, RM);
        assert_pair(x, &ratio.ln(BITS, RM, &mut c), "LN");
    }
    for (j, &(s, k)) in SIN_COS.iter().enumerate().skip(1) {
        assert_pair(s, &over_32(j).sin(BITS, RM, &mut c), "sin");
        assert_pair(k, &over_32(j).cos(BITS, RM, &mut c), "cos");
    }
    assert_eq!(SIN_COS[0], (DoubleDouble::ZERO, DoubleDouble::ONE));
    for (j, &x) in ATAN.iter().enumerate().skip(1) {
        assert_pair(x, &over_32(j).atan(BITS, RM, &mut c), "ATAN");
    }
    let mut factorial = number(1.0);
    for (j, &x) in INVERSE_FACTORIAL.iter().enumerate() {
        if j > 1 {
            factorial = factorial.mul(&number(j as f64), BITS, RM);
        }
        assert_pair(x, &factorial.reciprocal(BITS, RM), "INVERSE_FACTORIAL");
    }
    for (j, &x) in INVERSE_ODD.iter().enumerate() {
        assert_pair(
            x,
            &number(2.0 * j as f64 + 1.0).reciprocal(BITS, RM),
            "INVERSE_ODD",
        );
    }
}

#[test]
fn two_over_pi_has_1280_right_bits() {
    let mut c = Consts::new().unwrap();
    let bits = 1536;
    let exact = number(2.0).div(&c.pi(bits, RM), bits, RM);
    let unit = number(2f64.powi(-32));
    let mut sum = number(0.0);
    for &limb in &TWO_OVER_PI {
        sum = sum
            .add(&number(f64::from(limb)), bits, RM)
            .mul(&unit, bits, RM);
    }
    let rest = exact.sub(&sum, bits, RM);
    assert!(rest.is_positive() && rest.exponent() <= Some(-1280));
}
