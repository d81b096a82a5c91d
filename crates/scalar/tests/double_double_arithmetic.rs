//! + − × ÷ √ and the error-free sum of `DoubleDouble` against exact arithmetic, and the rules for special
//!   values.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::common::{BITS, RM, Random, Worst, big, error};
use astro_float::BigFloat;
use equip_scalar::{DoubleDouble, Float};

const COUNT: usize = 30_000;

/// Pairs of similar, of very different and of nearly cancelling numbers over the exponents [−spread, spread).
fn pairs(seed: u64, spread: f64) -> impl Iterator<Item = (DoubleDouble, DoubleDouble)> {
    let mut random = Random(seed);
    (0..COUNT).map(move |i| {
        let x = random.log_uniform(-spread, spread);
        let x = random.sign(x);
        let y = match i % 4 {
            0 => random.log_uniform(-spread, spread),
            1 => {
                let factor = random.log_uniform(-60.0, 60.0);
                DoubleDouble::new(x.hi() * factor.hi(), x.lo() * factor.hi())
            }
            2 => -random.with_tail(x.hi()),
            _ => {
                let step = random.unit() * 2f64.powi(-(random.bits() as i32 & 63));
                -random.with_tail(x.hi() * (1.0 + step))
            }
        };
        (x, if i % 8 < 4 { y } else { -y })
    })
}

fn usable(exact: f64) -> bool {
    exact.abs() < f64::MAX && exact.abs() > 1e-290
}

#[test]
fn sums_products_quotients_and_roots() {
    let mut worst = ["+", "−", "×", "÷", "√"].map(Worst::new);
    for (seed, spread) in [(1, 3.0), (2, 400.0), (3, 1000.0)] {
        for (x, y) in pairs(seed, spread) {
            let (a, b) = (big(x), big(y));
            let sum = a.add_full_prec(&b);
            if !sum.is_zero() && usable((x + y).hi()) {
                worst[0].record([x, y], error(x + y, &sum));
            }
            let difference = a.sub_full_prec(&b);
            if !difference.is_zero() && usable((x - y).hi()) {
                worst[1].record([x, y], error(x - y, &difference));
            }
            if usable(x.hi() * y.hi()) {
                worst[2].record([x, y], error(x * y, &a.mul_full_prec(&b)));
            }
            if usable(x.hi() / y.hi()) {
                worst[3].record([x, y], error(x / y, &a.div(&b, BITS, RM)));
            }
            worst[4].record([x, x], error(x.abs().sqrt(), &a.abs().sqrt(BITS, RM)));
        }
    }
    // Proved: 0.75, 0.75, 1.25, 3.75, 0.79. Measured: 0.50, 0.50, 0.89, 1.49, 0.70.
    for (worst, bound) in worst.iter().zip([0.751, 0.751, 1.251, 3.751, 0.79]) {
        worst.assert(COUNT, bound);
    }
}

/// Beyond the range of Dekker's splitting, and down to where subnormal numbers take over.
#[test]
fn ends_of_the_exponent_range() {
    let mut random = Random(4);
    for _ in 0..COUNT {
        let x = random.log_uniform(990.0, 1023.0);
        let y = random.log_uniform(-40.0, 40.0);
        for (computed, exact) in [
            (x * y, big(x).mul_full_prec(&big(y))),
            (x / y, big(x).div(&big(y), BITS, RM)),
            (y / x, big(y).div(&big(x), BITS, RM)),
            (x + y, big(x).add_full_prec(&big(y))),
            (x.sqrt(), big(x).sqrt(BITS, RM)),
        ] {
            if computed.is_infinite() {
                assert!(x.hi() * y.hi() > 1e308 || x.hi() / y.hi() > 1e308 || x.hi() > 1e308);
            } else {
                assert!(error(computed, &exact) < 3.75, "{x:?} {y:?}");
            }
        }
        let (x, y) = (
            random.log_uniform(-1070.0, -960.0),
            random.log_uniform(-1070.0, -960.0),
        );
        assert!(
            error(x / y, &big(x).div(&big(y), BITS, RM)) < 3.75,
            "{x:?} {y:?}"
        );
        assert!(error(x.sqrt(), &big(x).sqrt(BITS, RM)) < 3.75, "{x:?}");
        assert!(
            error(x + y, &big(x).add_full_prec(&big(y))) < 0.751,
            "{x:?} {y:?}"
        );
    }
    assert_eq!(
        DoubleDouble::MAX + DoubleDouble::from(1.0),
        DoubleDouble::MAX
    );
    assert_eq!(DoubleDouble::MAX * DoubleDouble::ONE, DoubleDouble::MAX);
    assert_eq!(DoubleDouble::MAX / DoubleDouble::ONE, DoubleDouble::MAX);
    assert!((DoubleDouble::MAX + DoubleDouble::MAX).is_infinite());
    assert!((DoubleDouble::MAX * DoubleDouble::MIN).is_infinite());
    assert!(
        error(
            DoubleDouble::MAX.sqrt(),
            &big(DoubleDouble::MAX).sqrt(BITS, RM)
        ) < 1.0
    );
}

/// Every zero, infinity and NaN is that of `f64`, sign of zero included; other results agree to its
/// precision.
#[test]
fn special_values_follow_double() {
    let subnormal = 5e-324;
    let values = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        f64::MAX,
        f64::MIN_POSITIVE,
        subnormal,
    ];
    let same = |dd: DoubleDouble, double: f64, what: &str| {
        let hi = dd.hi();
        let ordinary =
            hi.is_finite() && hi != 0.0 && (hi - double).abs() <= 4.5e-16 * hi.abs() + 5e-324;
        let equal = ordinary || hi.is_nan() && double.is_nan() || hi.to_bits() == double.to_bits();
        assert!(equal, "{what}: {dd:?} instead of {double:?}");
        assert!(dd.is_finite() || dd.lo() == 0.0, "{what}: {dd:?}");
    };
    for x in values {
        let a = DoubleDouble::from(x);
        for y in values {
            let b = DoubleDouble::from(y);
            same(a + b, x + y, &format!("{x} + {y}"));
            same(a - b, x - y, &format!("{x} - {y}"));
            same(a * b, x * y, &format!("{x} * {y}"));
            same(a / b, x / y, &format!("{x} / {y}"));
            same(a % b, x % y, &format!("{x} % {y}"));
            same(a.atan2(b), x.atan2(y), &format!("atan2 {x} {y}"));
            same(a.hypot(b), x.hypot(y), &format!("hypot {x} {y}"));
            same(a.powf(b), x.powf(y), &format!("pow {x} {y}"));
            same(a.copysign(b), x.copysign(y), &format!("copysign {x} {y}"));
            if x != y {
                same(a.min(b), x.min(y), &format!("min {x} {y}"));
                same(a.max(b), x.max(y), &format!("max {x} {y}"));
            }
            assert_eq!(a.partial_cmp(&b), x.partial_cmp(&y));
            assert_eq!(a == b, x == y);
        }
        macro_rules! unary {
            ($($f:ident),*) => {$(same(a.$f(), x.$f(), &format!("{} {x}", stringify!($f)));)*};
        }
        unary!(
            sqrt, cbrt, recip, exp, exp2, exp_m1, ln, ln_1p, log2, log10, sinh, cosh, tanh, atanh,
            asin, acos, atan, floor, ceil, trunc, round, abs, signum
        );
        // std's asinh and acosh overflow at MAX; sin MAX is tested with the functions.
        if x != f64::MAX {
            unary!(asinh, acosh, sin, cos, tan);
        }
        for n in [-2, -1, 0, 1, 2, 3] {
            same(a.powi(n), x.powi(n), &format!("{x} ^ {n}"));
        }
    }
    // Only double-double sees on which side of 1 the base lies.
    let above = DoubleDouble::new(1.0, 1e-20);
    assert!(above.powf(DoubleDouble::INFINITY).is_infinite());
    assert_eq!(
        DoubleDouble::new(1.0, -1e-20).powf(DoubleDouble::INFINITY),
        DoubleDouble::ZERO
    );
}

#[test]
fn rounding_to_integers() {
    let mut random = Random(5);
    for _ in 0..COUNT {
        let x = random.log_uniform(-3.0, 110.0);
        let x = random.sign(x);
        let (floor, ceil, round) = (x.floor(), x.ceil(), x.round());
        assert!(
            floor <= x && x < floor + DoubleDouble::ONE || x.hi().abs() > 1e30,
            "{x:?}"
        );
        assert!(ceil >= x && (ceil == floor) == (x == floor), "{x:?}");
        assert!((x - round).abs() <= DoubleDouble::from(0.5), "{x:?}");
        let parts = [x.trunc(), x.fract()].map(big);
        let sum = if parts.iter().any(|part| part.is_zero()) {
            parts[0].add(&parts[1], 512, RM)
        } else {
            parts[0].add_full_prec(&parts[1])
        };
        assert_eq!(sum, big(x), "{x:?}");
        assert_eq!(x.to_i128().map(DoubleDouble::from_i128), Some(x.trunc()));
    }
    let half_below = DoubleDouble::new(4.0, -0.5);
    assert_eq!(half_below.round(), DoubleDouble::from(4.0));
    let whole = DoubleDouble::new(2f64.powi(60), -0.5);
    assert_eq!(whole.round(), DoubleDouble::from(2f64.powi(60)));
    assert_eq!(whole.floor(), DoubleDouble::new(2f64.powi(60), -1.0));
    assert_eq!(
        DoubleDouble::from_i64(i64::MAX).to_i128(),
        Some(i128::from(i64::MAX))
    );
    assert_eq!(
        DoubleDouble::from_i64(i64::MIN).to_i128(),
        Some(i128::from(i64::MIN))
    );
    assert_eq!(DoubleDouble::from(2f64.powi(127)).to_i128(), None);
    assert_eq!(
        DoubleDouble::from(-2f64.powi(127)).to_i128(),
        Some(i128::MIN)
    );
    assert_eq!(DoubleDouble::from(2f64.powi(128)).to_u128(), None);
    assert_eq!(DoubleDouble::from(-1.0).to_u128(), None);
    assert_eq!(DoubleDouble::NAN.to_i128(), None);
}

#[test]
fn remainder_is_exact_or_rounded_once() {
    let mut random = Random(6);
    for _ in 0..3000 {
        let (x, y) = (
            random.log_uniform(-50.0, 200.0),
            random.log_uniform(-50.0, 50.0),
        );
        let rest = x % y;
        assert!(rest >= DoubleDouble::ZERO && rest < y);
        // x less the multiple of y next to x − rest.
        let half = BigFloat::from_f64(0.5, 64);
        let quotient = big(x).sub(&big(rest), 900, RM).div(&big(y), 900, RM);
        let multiple = quotient.add(&half, 900, RM).floor();
        let exact = big(x).sub(&multiple.mul(&big(y), 900, RM), 900, RM);
        // Rounded only where the remainder has more bits than two doubles hold.
        assert!(
            rest == DoubleDouble::ZERO || error(rest, &exact) <= 0.25,
            "{x:?} % {y:?} = {rest:?}"
        );
    }
}

/// Unlike Knuth's formula in double-double arithmetic, the override loses nothing.
#[test]
fn two_sum_is_error_free() {
    for (seed, spread) in [(7, 3.0), (8, 120.0), (9, 900.0)] {
        for (x, y) in pairs(seed, spread) {
            let (s, e) = <DoubleDouble as Float>::two_sum(x, y);
            if !usable(s.hi()) {
                continue;
            }
            let exact = big(x).add_full_prec(&big(y));
            assert!(
                exact
                    .sub_full_prec(&big(s))
                    .sub_full_prec(&big(e))
                    .is_zero(),
                "{x:?} {y:?}"
            );
            assert!(
                e.hi().abs() <= s.hi().abs() * 2f64.powi(-104),
                "{x:?} {y:?} {s:?} {e:?}"
            );
            assert_eq!(s.hi() + s.lo(), s.hi());
        }
    }
    let (s, e) = <DoubleDouble as Float>::two_sum(DoubleDouble::INFINITY, DoubleDouble::ONE);
    assert_eq!((s, e), (DoubleDouble::INFINITY, DoubleDouble::ZERO));
}

#[test]
fn compensated_sum_beats_the_plain_one() {
    let mut random = Random(10);
    let terms: Vec<DoubleDouble> = (0..100_000).map(|_| random.between(0.0, 1.0)).collect();
    let exact = terms
        .iter()
        .fold(big(DoubleDouble::ZERO), |sum, &x| sum.add(&big(x), 512, RM));
    let plain: DoubleDouble = terms.iter().sum();
    let (mut sum, mut lost) = (DoubleDouble::ZERO, DoubleDouble::ZERO);
    for &x in &terms {
        let (next, rest) = <DoubleDouble as Float>::two_sum(sum, x);
        sum = next;
        lost += rest;
    }
    let (plain, compensated) = (error(plain, &exact), error(sum + lost, &exact));
    println!("running sum of 100 000 terms: plain {plain:.2}, compensated {compensated:.3}");
    // Measured, in units of 2⁻¹⁰⁴: 7.4 plain, 0.003 compensated.
    assert!(compensated < 0.75 && compensated * 10.0 < plain);
}
