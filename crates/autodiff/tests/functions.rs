//! First, second and third derivatives of functions of one variable against closed forms.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use crate::common::Random;
use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{DoubleDouble, Float, Scalar};
use std::ops::Range;

type T = DoubleDouble;

/// f′, f″ and, from differences of f″ with step 1e-10, f‴.
fn derivatives<F: Float>(f: fn(Var) -> Var, x: F) -> [F; 3] {
    let h = Hamiltonian::new(1, |q, p| f(q[0]) + p[0] * p[0]).unwrap();
    let mut evaluator = h.evaluator::<F>();
    let mut gradient = [F::int(0); 2];
    evaluator.gradient(&[x, F::int(0)], &mut gradient);
    let mut second = |x: F| {
        let mut entries = [F::int(0); 2];
        evaluator.hessian(&[x, F::int(0)], &mut entries);
        entries[0]
    };
    let step = F::exact(1e-10);
    let third = (second(x + step) - second(x - step)) / (step + step);
    [gradient[0], second(x), third]
}

fn check(name: &str, f: fn(Var) -> Var, closed: fn(T) -> [T; 3], within: Range<f64>) {
    let mut random = Random(0x5eed_0031);
    let mut worst = [0.0_f64; 5];
    for _ in 0..100 {
        let x = random.within(within.start, within.end);
        let wide = T::from(x);
        let expected = closed(wide);
        let (double, extended) = (derivatives(f, x), derivatives(f, wide));
        let size = |k: usize| expected[k].hi().abs().max(0.1);
        for k in 0..2 {
            let error = (T::from(double[k]) - expected[k]).hi().abs() / size(k);
            worst[k] = worst[k].max(error / f64::EPSILON);
        }
        for k in 0..3 {
            let error = (extended[k] - expected[k]).hi().abs() / size(k);
            worst[2 + k] = worst[2 + k].max(error / T::EPSILON.hi());
        }
    }
    println!("{name:6} {worst:.1?}");
    assert!(worst[..4].iter().all(|&w| w < 8.0), "{name}: {worst:?}");
    // Differences: 1e-20 f⁗′/6, ε f″/1e-10.
    assert!(worst[4] * T::EPSILON.hi() < 1e-15, "{name}: {worst:?}");
}

/// Measured, in roundings of either float: 3.4 at most; relative, below 0.1 absolute.
#[test]
fn derivatives_to_the_third() {
    check(
        "cbrt",
        |x| x.cbrt(),
        |x| {
            let third = x.cbrt() / x / T::from_i64(3);
            let second = third / x * T::ratio(-2, 3);
            [third, second, second / x * T::ratio(-5, 3)]
        },
        -3.0..-0.1,
    );
    check(
        "exp2",
        |x| x.exp2(),
        |x| [1, 2, 3].map(|k| x.exp2() * T::LN_2.powi(k)),
        -6.0..6.0,
    );
    check(
        "log10",
        |x| x.log10(),
        |x| {
            let f = T::LOG10_E / x;
            [f, -f / x, (f + f) / x / x]
        },
        0.1..9.0,
    );
    check(
        "asinh",
        |x| x.asinh(),
        |x| {
            let r = (T::ONE + x * x).sqrt();
            let third = (x * x + x * x - T::ONE) / r.powi(5);
            [r.recip(), -x / r.powi(3), third]
        },
        -3.0..3.0,
    );
    check(
        "acosh",
        |x| x.acosh(),
        |x| {
            let r = ((x - T::ONE) * (x + T::ONE)).sqrt();
            let third = (x * x + x * x + T::ONE) / r.powi(5);
            [r.recip(), -x / r.powi(3), third]
        },
        1.2..5.0,
    );
    check(
        "atanh",
        |x| x.atanh(),
        |x| {
            let r = ((T::ONE - x) * (T::ONE + x)).recip();
            let third = (T::from(6.0) * x * x + T::from(2.0)) * r.powi(3);
            [r, (x + x) * r * r, third]
        },
        -0.8..0.8,
    );
    check("erf", |x| x.erf(), gaussians, -2.0..2.0);
    check(
        "erfc",
        |x| x.erfc(),
        |x| gaussians(x).map(|x| -x),
        -2.0..2.0,
    );
}

/// Derivatives of erf.
fn gaussians(x: T) -> [T; 3] {
    let first = T::FRAC_2_SQRT_PI * (-x * x).exp();
    let second = -(x + x) * first;
    [first, second, (T::from(4.0) * x * x - T::from(2.0)) * first]
}

/// At 0 no derivative is lost to |x| or to 0/0, and far out nothing overflows.
#[test]
fn at_zero_and_far_out() {
    let at = |f: fn(Var) -> Var, x: f64| derivatives(f, x);
    assert_eq!(at(|x| x.asinh(), 0.0)[..2], [1.0, 0.0]);
    assert_eq!(at(|x| x.atanh(), 0.0)[..2], [1.0, 0.0]);
    assert_eq!(at(|x| x.exp2(), 0.0)[0], std::f64::consts::LN_2);
    assert_eq!(at(|x| x.cbrt(), 0.0)[0], f64::INFINITY);
    assert_eq!(at(|x| x.erf(), 0.0)[0], std::f64::consts::FRAC_2_SQRT_PI);
    assert_eq!(at(|x| x.asinh(), 1e200)[0], 1e-200);
    assert_eq!(at(|x| x.acosh(), 1e200)[0], 1e-200);
    assert_eq!(at(|x| x.erf(), 40.0)[..2], [0.0, 0.0]);
    assert_eq!(at(|x| x.signum() * x, -2.0)[..2], [-1.0, 0.0]);
    let choice = |x: Var| x.select(x * x, -x);
    assert_eq!(at(choice, 3.0)[..2], [6.0, 2.0]);
    assert_eq!(at(choice, 0.0)[..2], [0.0, 2.0]);
    assert_eq!(at(choice, -3.0)[..2], [-1.0, 0.0]);
    assert_eq!(<f64 as Scalar>::select(-3.0, 9.0, 3.0), 3.0);
}
