//! Elementary functions of `DoubleDouble` against astro-float.

mod common;
use astro_float::{BigFloat, Consts};
use common::{BITS, RM, Random, Worst, big, consts, error};
use equip_scalar::DoubleDouble;

const COUNT: usize = 10_000;

/// Runs `f` against `exact` over the arguments.
fn check(
    name: &'static str,
    bound: f64,
    arguments: impl Iterator<Item = DoubleDouble>,
    f: impl Fn(DoubleDouble) -> DoubleDouble,
    exact: impl Fn(&BigFloat, &mut Consts) -> BigFloat,
) {
    let mut consts = consts();
    let mut worst = Worst::new(name);
    for x in arguments {
        worst.record(
            [x, DoubleDouble::ZERO],
            error(f(x), &exact(&big(x), &mut consts)),
        );
    }
    worst.assert(COUNT, bound);
}

/// A mix of generators, each taken in turn.
fn mix(
    seed: u64,
    generators: Vec<Box<dyn Fn(&mut Random) -> DoubleDouble>>,
) -> impl Iterator<Item = DoubleDouble> {
    let mut random = Random(seed);
    (0..COUNT).map(move |i| generators[i % generators.len()](&mut random))
}

/// Uniform in [a, b).
fn uniform(a: f64, b: f64) -> Box<dyn Fn(&mut Random) -> DoubleDouble> {
    Box::new(move |r| r.between(a, b))
}

/// ±2^k, k uniform in [a, b), with a random significand.
fn sizes(a: f64, b: f64) -> Box<dyn Fn(&mut Random) -> DoubleDouble> {
    Box::new(move |r| {
        let x = r.log_uniform(a, b);
        r.sign(x)
    })
}

/// The same, positive.
fn positive(a: f64, b: f64) -> Box<dyn Fn(&mut Random) -> DoubleDouble> {
    Box::new(move |r| r.log_uniform(a, b))
}

/// 1 ± 2^k.
fn near_one(a: f64, b: f64) -> Box<dyn Fn(&mut Random) -> DoubleDouble> {
    Box::new(move |r| {
        let x = r.log_uniform(a, b);
        DoubleDouble::ONE + r.sign(x)
    })
}

/// ±(1 − 2^k).
fn below_one(a: f64, b: f64) -> Box<dyn Fn(&mut Random) -> DoubleDouble> {
    Box::new(move |r| {
        let x = DoubleDouble::ONE - r.log_uniform(a, b);
        r.sign(x)
    })
}

/// Next to kπ/2 for k up to `limit`, as close as two doubles come.
fn near_multiples(limit: f64) -> Box<dyn Fn(&mut Random) -> DoubleDouble> {
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
    check("exp", 8.0, arguments(), DoubleDouble::exp, |x, c| {
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
    let exp_m1 = |x: &BigFloat, c: &mut Consts| {
        let bits = BITS + 2 * x.exponent().unwrap_or(0).unsigned_abs() as usize;
        x.exp(bits, RM, c)
            .sub(&BigFloat::from_f64(1.0, 64), bits, RM)
    };
    check("exp_m1", 8.0, near(), DoubleDouble::exp_m1, exp_m1);
    check("sinh", 8.0, near(), DoubleDouble::sinh, |x, c| {
        x.sinh(BITS, RM, c)
    });
    check("cosh", 8.0, near(), DoubleDouble::cosh, |x, c| {
        x.cosh(BITS, RM, c)
    });
    check("tanh", 8.0, near(), DoubleDouble::tanh, |x, c| {
        x.tanh(BITS, RM, c)
    });
    let exp2 = |x: &BigFloat, c: &mut Consts| {
        let two = BigFloat::from_f64(2.0, 64);
        two.pow(x, BITS, RM, c)
    };
    check(
        "exp2",
        8.0,
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
    check("ln", 8.0, arguments(), DoubleDouble::ln, |x, c| {
        x.ln(2 * BITS, RM, c)
    });
    check("log2", 8.0, arguments(), DoubleDouble::log2, |x, c| {
        x.log2(2 * BITS, RM, c)
    });
    check("log10", 8.0, arguments(), DoubleDouble::log10, |x, c| {
        x.log10(2 * BITS, RM, c)
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
        let bits = BITS + 2 * x.exponent().unwrap_or(0).unsigned_abs() as usize;
        x.add(&BigFloat::from_f64(1.0, 64), 2240, RM)
            .ln(bits, RM, c)
    };
    check("ln_1p", 8.0, near, DoubleDouble::ln_1p, ln_1p);
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
    check("asinh", 8.0, arguments, DoubleDouble::asinh, |x, c| {
        x.asinh(BITS, RM, c)
    });
    let above_one: Box<dyn Fn(&mut Random) -> DoubleDouble> =
        Box::new(|r| DoubleDouble::ONE + r.log_uniform(-100.0, 0.0));
    let arguments = mix(7, vec![above_one, positive(1.0, 1000.0), uniform(1.0, 4.0)]);
    check("acosh", 8.0, arguments, DoubleDouble::acosh, |x, c| {
        x.acosh(2 * BITS, RM, c)
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
    check("atanh", 8.0, arguments, DoubleDouble::atanh, |x, c| {
        x.atanh(2 * BITS, RM, c)
    });
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
    check("sin", 8.0, arguments(), DoubleDouble::sin, |x, c| {
        x.sin(wide(x), RM, c)
    });
    check("cos", 8.0, arguments(), DoubleDouble::cos, |x, c| {
        x.cos(wide(x), RM, c)
    });
    check("tan", 8.0, arguments(), DoubleDouble::tan, |x, c| {
        x.tan(wide(x), RM, c)
    });
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
    check("asin", 8.0, arguments(), DoubleDouble::asin, |x, c| {
        x.asin(2 * BITS, RM, c)
    });
    check("acos", 8.0, arguments(), DoubleDouble::acos, |x, c| {
        x.acos(2 * BITS, RM, c)
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
    check("atan", 8.0, arguments, DoubleDouble::atan, |x, c| {
        x.atan(BITS, RM, c)
    });

    let mut worst = Worst::new("atan2");
    let (mut random, mut c) = (Random(12), consts());
    for i in 0..COUNT {
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
    worst.assert(COUNT * 9 / 10, 8.0);
}

#[test]
fn powers() {
    let (mut random, mut c) = (Random(13), consts());
    let mut small = Worst::new("powi ≤ 6");
    let mut large = Worst::new("powi / n");
    for i in 0..COUNT {
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
        let power = big(x).powi(n.unsigned_abs() as usize, 2 * BITS, RM);
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
    small.assert(COUNT / 3, 8.0);
    large.assert(COUNT / 3, 1.3);

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
    // The error as a fraction of the stated (8 + 4 |y ln x|).
    worst.assert(COUNT, 1.0);
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
    worst.assert(COUNT, 8.0);
    check(
        "cbrt",
        8.0,
        mix(15, vec![sizes(-960.0, 1020.0), uniform(-10.0, 10.0)]),
        DoubleDouble::cbrt,
        |x, _| x.cbrt(BITS, RM),
    );
}
