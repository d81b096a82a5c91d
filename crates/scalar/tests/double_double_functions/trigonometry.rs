//! Trigonometric functions and their inverses.

use super::{COUNT, Generator, below_one, check, mix, sizes, uniform};
use crate::common::{BITS, RM, Random, Worst, big, consts, error};
use astro_float::BigFloat;
use equip_scalar::DoubleDouble;

/// Next to kπ/2 for k up to `limit`, as close as two doubles come.
fn near_multiples(limit: f64) -> Generator {
    Box::new(move |r| {
        let k = (2f64.powf(limit.log2() * r.unit())).floor();
        let x = DoubleDouble::FRAC_PI_2 * DoubleDouble::from(k);
        let shift = if r.bits() & 1 == 0 {
            DoubleDouble::ZERO
        } else {
            r.log_uniform(-110.0, -10.0)
        };
        let x = x + r.sign(shift);
        r.sign(x)
    })
}

/// As many bits as the argument of a trigonometric function needs.
fn wide(x: &BigFloat) -> usize {
    BITS + x.exponent().unwrap_or(0).max(0) as usize
}

#[test]
fn trigonometric() {
    let arguments = || {
        mix(
            9,
            vec![
                uniform(-4.0, 4.0),
                uniform(-1000.0, 1000.0),
                near_multiples(2f64.powi(20)),
                near_multiples(2f64.powi(60)),
                sizes(-300.0, 0.0),
                sizes(0.0, 100.0),
                uniform(-1.0, 1.0),
                sizes(-30.0, 0.0),
            ],
        )
    };
    // Measured: 0.65.
    check("sin", 1.0, arguments(), DoubleDouble::sin, |x, c| {
        x.sin(wide(x), RM, c)
    });
    // Measured: 0.52.
    check("cos", 0.8, arguments(), DoubleDouble::cos, |x, c| {
        x.cos(wide(x), RM, c)
    });
    // Measured: 1.14.
    check("tan", 1.8, arguments(), DoubleDouble::tan, |x, c| {
        x.tan(wide(x), RM, c)
    });
}

/// Where the reduction needs all of the 1280 bits of 2/π.
#[test]
fn trigonometric_of_huge_arguments() {
    let (mut random, mut c) = (Random(16), consts());
    let mut worst = Worst::new("sin huge");
    for i in 0..600 {
        let x = match i % 3 {
            0 => random.log_uniform(100.0, 1023.0),
            1 => near_multiples(2f64.powi(900))(&mut random),
            // The double next to a multiple of π/2 in all the range (Kahan), and a lower part that goes
            // closer.
            _ => DoubleDouble::new(
                6_381_956_970_095_103.0 * 2f64.powi(797),
                random.unit() * 2f64.powi(700 - i),
            ),
        };
        let (s, k) = x.sin_cos();
        let bits = BITS + 1100;
        let exact = [big(x).sin(bits, RM, &mut c), big(x).cos(bits, RM, &mut c)];
        worst.record([x, DoubleDouble::ZERO], error(s, &exact[0]));
        worst.record([x, DoubleDouble::ZERO], error(k, &exact[1]));
    }
    // Measured: 0.72.
    worst.assert(1200, 1.2);
}

#[test]
fn inverse_trigonometric() {
    let arguments = || {
        mix(
            10,
            vec![
                uniform(-1.0, 1.0),
                below_one(-100.0, -1.0),
                sizes(-300.0, -1.0),
                sizes(-20.0, -1.0),
            ],
        )
    };
    // Measured: 1.2.
    check("asin", 2.0, arguments(), DoubleDouble::asin, |x, c| {
        x.asin(BITS, RM, c)
    });
    // Measured: 1.23.
    check("acos", 2.0, arguments(), DoubleDouble::acos, |x, c| {
        x.acos(BITS, RM, c)
    });
    let arguments = mix(
        11,
        vec![
            uniform(-1.0, 1.0),
            sizes(-900.0, 900.0),
            uniform(-20.0, 20.0),
            sizes(-10.0, 10.0),
        ],
    );
    // Measured: 1.34.
    check("atan", 2.0, arguments, DoubleDouble::atan, |x, c| {
        x.atan(BITS, RM, c)
    });

    let mut worst = Worst::new("atan2");
    let (mut random, mut c) = (Random(12), consts());
    for i in 0..COUNT + 600 {
        let spread = [3.0, 60.0, 900.0][i % 3];
        let (y, x) = (
            random.log_uniform(-spread, spread),
            random.log_uniform(-spread / 2.0, spread),
        );
        let (y, x) = (random.sign(y), random.sign(x));
        if (y / x).abs() < DoubleDouble::MIN_POSITIVE {
            continue;
        }
        let mut exact = big(y).div(&big(x), BITS, RM).atan(BITS, RM, &mut c);
        if x.is_sign_negative() {
            let pi = c.pi(BITS, RM);
            exact = if y.is_sign_negative() {
                exact.sub(&pi, BITS, RM)
            } else {
                exact.add(&pi, BITS, RM)
            };
        }
        worst.record([y, x], error(y.atan2(x), &exact));
    }
    // Measured: 1.09.
    worst.assert(COUNT, 2.0);
}
