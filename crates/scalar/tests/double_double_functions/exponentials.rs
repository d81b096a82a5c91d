//! Exponentials, logarithms, powers and roots.

use super::{COUNT, Generator, below_one, check, mix, near_one, positive, sizes, uniform};
use crate::common::{BITS, RM, Random, Worst, big, consts, error};
use astro_float::{BigFloat, Consts};
use equip_scalar::DoubleDouble;

#[test]
fn exponentials() {
    let arguments = || {
        mix(
            1,
            vec![
                uniform(-700.0, 709.0),
                uniform(-1.0, 1.0),
                sizes(-120.0, 9.0),
                uniform(-40.0, 40.0),
            ],
        )
    };
    // Measured: 0.44.
    check("exp", 0.7, arguments(), DoubleDouble::exp, |x, c| {
        x.exp(BITS, RM, c)
    });
    let near = || {
        mix(
            2,
            vec![
                sizes(-300.0, 0.0),
                uniform(-0.5, 0.5),
                sizes(-60.0, 6.0),
                uniform(-80.0, 80.0),
                sizes(-1000.0, 0.0),
            ],
        )
    };
    // 2 sinh(x/2) exp(x/2): no cancellation in the reference.
    let exp_m1 = |x: &BigFloat, c: &mut Consts| {
        let half = x.mul_full_prec(&BigFloat::from_f64(0.5, 64));
        let product = half.sinh(BITS, RM, c).mul(&half.exp(BITS, RM, c), BITS, RM);
        product.add_full_prec(&product)
    };
    // Measured: 0.39.
    check("exp_m1", 0.7, near(), DoubleDouble::exp_m1, exp_m1);
    // Measured: 0.75.
    check("sinh", 1.2, near(), DoubleDouble::sinh, |x, c| {
        x.sinh(BITS, RM, c)
    });
    // Measured: 0.48.
    check("cosh", 0.8, near(), DoubleDouble::cosh, |x, c| {
        x.cosh(BITS, RM, c)
    });
    // Measured: 1.22.
    check("tanh", 2.0, near(), DoubleDouble::tanh, |x, c| {
        x.tanh(BITS, RM, c)
    });
    let exp2 = |x: &BigFloat, c: &mut Consts| {
        let two = BigFloat::from_f64(2.0, 64);
        two.pow(x, BITS, RM, c)
    };
    // Measured: 0.44.
    check(
        "exp2",
        0.7,
        mix(3, vec![uniform(-960.0, 1023.0), uniform(-1.0, 1.0)]),
        DoubleDouble::exp2,
        exp2,
    );
}

#[test]
fn logarithms() {
    let arguments = || {
        mix(
            4,
            vec![
                positive(-960.0, 1023.0),
                uniform(0.5, 2.0),
                near_one(-100.0, -1.0),
                near_one(-20.0, -1.0),
                uniform(0.0, 10.0),
            ],
        )
    };
    // Measured: 1.09.
    check("ln", 2.0, arguments(), DoubleDouble::ln, |x, c| {
        x.ln(BITS, RM, c)
    });
    // Measured: 1.15.
    check("log2", 2.0, arguments(), DoubleDouble::log2, |x, c| {
        x.log2(BITS, RM, c)
    });
    // Measured: 1.18.
    check("log10", 2.0, arguments(), DoubleDouble::log10, |x, c| {
        x.log10(BITS, RM, c)
    });
    let near = mix(
        5,
        vec![
            sizes(-300.0, -1.0),
            uniform(-0.9, 1.0),
            below_one(-100.0, -1.0),
            positive(-10.0, 1000.0),
            sizes(-900.0, -1.0),
            uniform(-0.05, 0.05),
        ],
    );
    let ln_1p = |x: &BigFloat, c: &mut Consts| {
        if x.exponent() > Some(-5) {
            return x
                .add_full_prec(&BigFloat::from_f64(1.0, 64))
                .ln(BITS, RM, c);
        }
        // 2 artanh(x/(2 + x)): 1 + x would have too many bits.
        let s = x
            .div(&x.add(&BigFloat::from_f64(2.0, 64), BITS, RM), BITS, RM)
            .atanh(BITS, RM, c);
        s.add_full_prec(&s)
    };
    // Measured: 0.96.
    check("ln_1p", 1.6, near, DoubleDouble::ln_1p, ln_1p);
}

#[test]
fn inverse_hyperbolic() {
    let arguments = mix(
        6,
        vec![
            sizes(-900.0, 1000.0),
            uniform(-3.0, 3.0),
            sizes(-10.0, 10.0),
            sizes(-100.0, 0.0),
        ],
    );
    // Measured: 1.1.
    check("asinh", 2.0, arguments, DoubleDouble::asinh, |x, c| {
        x.asinh(BITS, RM, c)
    });
    let above_one: Generator = Box::new(|r| DoubleDouble::ONE + r.log_uniform(-100.0, 0.0));
    let arguments = mix(7, vec![above_one, positive(1.0, 1000.0), uniform(1.0, 4.0)]);
    // Measured: 1.4.
    check("acosh", 2.2, arguments, DoubleDouble::acosh, |x, c| {
        x.acosh(BITS, RM, c)
    });
    let arguments = mix(
        8,
        vec![
            uniform(-1.0, 1.0),
            sizes(-900.0, -1.0),
            below_one(-100.0, -1.0),
            sizes(-20.0, -1.0),
        ],
    );
    // Measured: 1.3.
    check("atanh", 2.0, arguments, DoubleDouble::atanh, |x, c| {
        x.atanh(BITS, RM, c)
    });
}

#[test]
fn powers() {
    let (mut random, mut c) = (Random(13), consts());
    let mut small = Worst::new("powi ≤ 6");
    let mut large = Worst::new("powi / n");
    for i in 0..2 * COUNT + 1500 {
        let n = if i % 2 == 0 {
            (random.bits() % 13) as i32 - 6
        } else {
            (random.bits() % 400) as i32 - 200
        };
        let x = random.log_uniform(-3.0, 3.0);
        let x = random.sign(x);
        if n == 0 {
            assert_eq!(x.powi(0), DoubleDouble::ONE);
            continue;
        }
        let power = big(x).powi(n.unsigned_abs() as usize, BITS, RM);
        let exact = if n > 0 {
            power
        } else {
            power.reciprocal(BITS, RM)
        };
        let error = error(x.powi(n), &exact);
        if n.abs() <= 6 {
            small.record([x, n.into()], error)
        } else {
            large.record([x, n.into()], error / f64::from(n.abs()))
        }
    }
    // Measured: 2.1 up to |n| = 6; 0.40 |n| beyond (a product may cost 1.25).
    small.assert(9_900, 4.0);
    large.assert(COUNT, 0.6);

    let mut worst = Worst::new("powf*");
    for i in 0..COUNT {
        let x = if i % 3 == 0 {
            DoubleDouble::ONE + random.log_uniform(-50.0, -1.0)
        } else {
            random.log_uniform(-20.0, 20.0)
        };
        let y = random.between(-30.0, 30.0);
        let exact = big(x).pow(&big(y), BITS, RM, &mut c);
        let amplification = 8.0 + 4.0 * (y.hi() * x.hi().ln()).abs();
        worst.record([x, y], error(x.powf(y), &exact) / amplification);
    }
    // The error as a fraction of the stated 8 + 4 |y ln x|. Measured: 0.18.
    worst.assert(COUNT, 0.5);
}

#[test]
fn roots() {
    let mut worst = Worst::new("hypot");
    let mut random = Random(14);
    for i in 0..COUNT {
        let spread = [2.0, 20.0, 900.0][i % 3];
        let (x, y) = (
            random.log_uniform(-spread, spread),
            random.log_uniform(-spread, spread),
        );
        let square = |x: DoubleDouble| big(x).mul(&big(x), 2240, RM);
        let exact = square(x).add(&square(y), 2240, RM).sqrt(BITS, RM);
        worst.record([x, y], error(x.hypot(y), &exact));
    }
    // Measured: 0.65.
    worst.assert(COUNT, 1.0);
    // Measured: 0.22.
    check(
        "cbrt",
        0.4,
        mix(15, vec![sizes(-960.0, 1020.0), uniform(-10.0, 10.0)]),
        DoubleDouble::cbrt,
        |x, _| x.cbrt(BITS, RM),
    );
}
