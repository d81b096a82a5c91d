//! erf and erfc against the series erf x = 2/√π exp(−x²) Σ 2ⁿ x²ⁿ⁺¹/(2n + 1)!! in 1500 bits, so that the
//! digits that 1 − erf x loses are there.

use crate::common::{RM, Random, Worst, big, consts, error};
use astro_float::{BigFloat, Consts};
use equip_scalar::DoubleDouble;

/// erfc 26 is 2^−980.
const LONG: usize = 1500;
const COUNT: usize = 240;

fn number(x: f64) -> BigFloat {
    BigFloat::from_f64(x, 64)
}

fn erf(x: &BigFloat, c: &mut Consts) -> BigFloat {
    let square = x.mul(x, LONG, RM);
    let twice = square.add_full_prec(&square);
    let (mut term, mut sum) = (x.clone(), x.clone());
    let mut n = 1.0;
    loop {
        n += 2.0;
        term = term.mul(&twice, LONG, RM).div(&number(n), LONG, RM);
        sum = sum.add(&term, LONG, RM);
        if term.is_zero() || term.exponent() < sum.exponent().map(|e| e - LONG as i32) {
            break;
        }
    }
    let root = c.pi(LONG, RM).sqrt(LONG, RM);
    let factor = square.neg().exp(LONG, RM, c).div(&root, LONG, RM);
    sum.add_full_prec(&sum).mul(&factor, LONG, RM)
}

#[test]
fn error_functions() {
    let (mut random, mut c) = (Random(21), consts());
    let [mut of_erf, mut of_erfc] = ["erf", "erfc"].map(Worst::new);
    for i in 0..COUNT {
        let x = match i % 6 {
            0 => random.log_uniform(-300.0, 0.0),
            1 => random.between(0.4, 1.1),
            2 => random.between(8.5, 9.5),
            3 => random.between(0.0, 25.0),
            _ => random.between(0.0, 6.0),
        };
        let x = if i % 4 == 0 { -x } else { x };
        let exact = erf(&big(x), &mut c);
        let rest = number(1.0).sub(&exact, LONG, RM);
        of_erf.record([x, DoubleDouble::ZERO], error(x.erf(), &exact));
        of_erfc.record([x, DoubleDouble::ZERO], error(x.erfc(), &rest));
    }
    // Measured: 0.32 and 1.04.
    of_erf.assert(COUNT, 0.6);
    of_erfc.assert(COUNT, 1.6);
}

#[test]
fn published_values() {
    // Abramowitz, Stegun 1964, table 7.1.
    let near = |x: DoubleDouble, digits: &str| {
        let expected: DoubleDouble = digits.parse().unwrap();
        assert!(
            ((x - expected) / expected).abs().hi() < 1e-10,
            "{x} {digits}"
        );
    };
    near(DoubleDouble::from(0.5).erf(), "0.5204998778");
    near(DoubleDouble::from(1.0).erf(), "0.8427007929");
    near(DoubleDouble::from(2.0).erf(), "0.9953222650");
    assert_eq!(DoubleDouble::INFINITY.erf(), DoubleDouble::ONE);
    assert_eq!(DoubleDouble::NEG_INFINITY.erfc(), DoubleDouble::from(2.0));
    assert!(DoubleDouble::NAN.erf().is_nan() && DoubleDouble::NAN.erfc().is_nan());
}
