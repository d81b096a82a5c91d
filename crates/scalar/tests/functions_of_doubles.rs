//! Functions of `f64` that are not those of the standard library, or not known to be as exact, against
//! double-double, of which `double_double_functions` tests every one against astro-float.

use crate::common::Random;
use equip_scalar::{DoubleDouble, Float, Num, Scalar};

const COUNT: usize = 20_000;

/// Largest relative error in units of ε = 2⁻⁵², over numbers of all sizes and signs that `argument` makes of
/// a size and a uniform number.
fn worst(
    f: fn(f64) -> f64,
    exact: fn(DoubleDouble) -> DoubleDouble,
    argument: fn(f64, f64) -> f64,
) -> f64 {
    let mut random = Random(0x5eed_0017);
    let mut worst = 0.0_f64;
    for _ in 0..COUNT {
        let size = random.log_uniform(-100.0, 100.0).hi();
        let x = argument(size, 2.0 * random.unit() - 1.0);
        let expected = exact(DoubleDouble::from(x));
        if expected.hi().abs() > 1e-290 && expected.is_finite() {
            let error = (DoubleDouble::from(f(x)) - expected) / expected;
            worst = worst.max(error.to_f64().abs() / f64::EPSILON);
        }
    }
    worst
}

#[test]
fn a_few_roundings_over_the_whole_range() {
    let any = |size: f64, unit: f64| {
        if unit < 0.0 { -size } else { size }
    };
    let moderate = |_: f64, unit: f64| 4.0 * unit;
    let near_one = |size: f64, unit: f64| 1.0 + unit.abs() * size.min(1.0 / size);
    let below_one =
        |size: f64, unit: f64| unit.signum() * (1.0 - unit.abs() * size.min(1.0 / size));
    type Case = (
        &'static str,
        fn(f64) -> f64,
        fn(DoubleDouble) -> DoubleDouble,
        Vec<fn(f64, f64) -> f64>,
    );
    // Measured, in this order: 0.49 0.50 0.93 1.29 1.09 0.69 1.50 0.99.
    let cases: [Case; 8] = [
        ("cbrt", Scalar::cbrt, Scalar::cbrt, vec![any, moderate]),
        (
            "exp2",
            Scalar::exp2,
            Scalar::exp2,
            vec![|_, unit| 900.0 * unit, moderate],
        ),
        ("asinh", Scalar::asinh, Scalar::asinh, vec![any, moderate]),
        (
            "acosh",
            Scalar::acosh,
            Scalar::acosh,
            vec![near_one, |size, _| 1.0 + size],
        ),
        (
            "atanh",
            Scalar::atanh,
            Scalar::atanh,
            vec![below_one, |_, unit| unit, |size, unit| unit * size.min(1.0)],
        ),
        ("erf", Scalar::erf, Scalar::erf, vec![any, moderate]),
        (
            "erfc",
            Scalar::erfc,
            Scalar::erfc,
            vec![moderate, |_, unit| 26.0 * unit],
        ),
        (
            "log10",
            |x| Num(x).log10().0,
            DoubleDouble::log10,
            vec![|size, _| size, |_, unit| unit.abs()],
        ),
    ];
    for (name, f, exact, arguments) in cases {
        let worst = arguments.iter().map(|&argument| worst(f, exact, argument));
        let worst = worst.fold(0.0, f64::max);
        println!("{name:6} {worst:.2}");
        assert!(worst <= 2.0, "{name}: {worst} roundings");
    }
}

#[test]
fn special_values() {
    let outside: [f64; 3] = [Scalar::acosh(0.5), Scalar::atanh(1.5), Scalar::atanh(-1.5)];
    assert!(outside.iter().all(|x| x.is_nan()));
    assert_eq!(Scalar::atanh(-1.0), f64::NEG_INFINITY);
    assert_eq!(<f64 as Scalar>::acosh(1.0), 0.0);
    assert_eq!(<f64 as Scalar>::acosh(1e308), (1e308_f64).ln() + 2_f64.ln());
    assert_eq!(<f64 as Scalar>::cbrt(-27.0), -3.0);
    assert_eq!([-1074.0, 10.0].map(<f64 as Scalar>::exp2), [5e-324, 1024.0]);
    assert_eq!(
        [-1.0, 0.0, 3.0].map(<f64 as Scalar>::signum),
        [-1.0, 0.0, 1.0]
    );
    let choose = |test: f64| <f64 as Scalar>::select(test, 1.0, 2.0);
    assert_eq!([-1e-300, -0.0, 0.0, 1.0].map(choose), [2.0, 1.0, 1.0, 1.0]);
    assert_eq!(choose(f64::NAN), 2.0);
    let clamp = |x: f64| Num(x).clamp(-1, 2.5).0;
    assert_eq!([-3.0, 0.5, 3.0].map(clamp), [-1.0, 0.5, 2.5]);
    let x = Num(3.0);
    assert_eq!((2 * x - x / 2 + 1).0, 5.5);
    assert_eq!((7 - x).0, 4.0);
    let x = Num(DoubleDouble::from(1.0));
    assert_eq!((x / 3).0, DoubleDouble::ratio(1, 3));
}
