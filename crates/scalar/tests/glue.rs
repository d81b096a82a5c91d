//! `DoubleDouble` under num-traits, num-dual, approx and nalgebra, and the dual numbers over it and over
//! `f64`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::common::Random;
use equip_scalar::{Constant, DoubleDouble, FirstOrder, Float, Num, Scalar, ratio};
use nalgebra::{ComplexField, DMatrix, DVector, RealField};

type Dd = DoubleDouble;

fn dd(x: f64) -> Dd {
    x.into()
}

#[test]
fn lu_solve_keeps_thirty_digits() {
    let mut random = Random(1);
    let n = 12;
    let a = DMatrix::from_fn(n, n, |i, j| {
        random.between(-1.0, 1.0) + dd(if i == j { 3.0 } else { 0.0 })
    });
    let x = DVector::from_fn(n, |_, _| random.between(-1.0, 1.0));
    let b = &a * &x;
    let solution = a.clone().lu().solve(&b).expect("regular");
    let error = (solution - &x).amax();
    println!("LU: {error:.1e}");
    // Measured: 3.7e-32.
    assert!(error < dd(2e-31));
    let eigen = (&a + a.transpose()).symmetric_eigen();
    let back = &eigen.eigenvectors
        * DMatrix::from_diagonal(&eigen.eigenvalues)
        * eigen.eigenvectors.transpose();
    let error = (back - (&a + a.transpose())).amax();
    println!("eigen: {error:.1e}");
    // Measured: 3.3e-30; the iteration stops at ε.
    assert!(error < dd(2e-29));
}

/// H = (p₁² + p₂²)/2 − 1/√(q₁² + q₂²).
fn kepler<S: Scalar>(y: [Num<S>; 4]) -> Num<S> {
    0.5 * (y[2] * y[2] + y[3] * y[3]) - (y[0] * y[0] + y[1] * y[1]).sqrt().recip()
}

#[test]
fn kepler_gradient_keeps_thirty_digits() {
    let point = [ratio(2, 5), ratio(-1, 7), ratio(1, 3), ratio(9, 5)].map(|c| c.to::<Dd>());
    type F = <Dd as Float>::Forward<4>;
    let y = std::array::from_fn(|i| Num(F::variable(point[i], i)));
    let h = kepler(y).0;
    // By hand: ∂/∂q (−1/r) = q/r³.
    let square = point[0] * point[0] + point[1] * point[1];
    let third = square * <Dd as Scalar>::sqrt(square);
    let exact = [point[0] / third, point[1] / third, point[2], point[3]];
    let mut worst = dd(0.0);
    for (found, exact) in h.gradient().into_iter().zip(exact) {
        worst = RealField::max(worst, ComplexField::abs(found - exact));
    }
    println!("gradient: {worst:.1e}, of entries up to 6");
    assert!(worst < dd(1e-30));
    assert_eq!(h.value(), kepler(point.map(Num)).0);
}

/// Every derivative of the functions of one argument, against central differences in double-double of
/// functions evaluated in double-double: right to about 1e-15.
#[test]
fn derivatives_agree_with_differences() {
    type F = <Dd as Float>::Forward<1>;
    let h = dd(2f64.powi(-26));
    macro_rules! check {
        ($($f:ident at $x:expr),* $(,)?) => {$(
            check!(stringify!($f), $x, |x| F::$f(x), |x| <Dd as Scalar>::$f(x));
        )*};
        ($name:expr, $x:expr, $dual:expr, $plain:expr) => {{
            let dual: fn(F) -> F = $dual;
            let plain: fn(Dd) -> Dd = $plain;
            let x = dd($x);
            let y = dual(F::variable(x, 0));
            let (left, mid, right) = (plain(x - h), plain(x), plain(x + h));
            let first = (right - left) / (h + h);
            assert!((y.value() - mid).abs() <= dd(1e-30) * mid.abs(), "{}", $name);
            assert!((y.gradient()[0] - first).abs() < dd(1e-12) * (first.abs() + dd(1.0)), "{}", $name);
        }};
    }
    check!(recip at 0.7, sqrt at 0.7, exp at 0.7, ln at 0.7, exp_m1 at 0.7, ln_1p at 0.7, sin at 0.7, cos at 0.7,
        tan at 0.7, asin at 0.3, acos at 0.3, atan at 0.7, sinh at 0.7, cosh at 0.7, tanh at 0.7, abs at -0.7);
    check!("powi 5", 1.3, |x| F::powi(x, 5), |x| <Dd as Scalar>::powi(
        x, 5
    ));
    check!("powi 2", 1.3, |x| F::powi(x, 2), |x| <Dd as Scalar>::powi(
        x, 2
    ));
    check!("powi 3", -1.3, |x| F::powi(x, 3), |x| <Dd as Scalar>::powi(
        x, 3
    ));
    check!("powi −1", -1.3, |x| F::powi(x, -1), |x| {
        <Dd as Scalar>::powi(x, -1)
    });
    check!("powi −4", 1.3, |x| F::powi(x, -4), |x| {
        <Dd as Scalar>::powi(x, -4)
    });
    check!("powf", 1.3, |x| F::powf(x, ratio(-3, 2)), |x| {
        <Dd as Scalar>::powf(x, ratio(-3, 2))
    });
    check!("pow", 1.3, |x| F::pow(x, x), |x| <Dd as Scalar>::pow(x, x));
    check!(
        "atan2",
        1.3,
        |x| F::atan2(x, F::constant(0.5.into())),
        |x| <Dd as Scalar>::atan2(x, dd(0.5))
    );
    check!(
        "atan2 flat",
        0.3,
        |x| F::atan2(x, F::constant((-1.5).into())),
        |x| <Dd as Scalar>::atan2(x, dd(-1.5))
    );
    check!(
        "hypot",
        1.3,
        |x| F::hypot(x, F::constant(0.5.into())),
        |x| <Dd as Scalar>::hypot(x, dd(0.5))
    );
}

/// What num-dual 0.15.1 answers with NaN.
fn singular_points<T: Float>() {
    let one = T::int(1);
    let zero = T::int(0);
    let at = |x: T| T::Forward::<2>::variable(x, 0);
    let derivatives = |y: T::Forward<2>| (y.value(), y.gradient());

    for power in [ratio(5, 2), ratio(3, 2), 2.0.into()] {
        assert!(derivatives(Scalar::powf(at(zero), power)) == (zero, [zero; 2]));
    }
    assert!(derivatives(Scalar::powf(at(zero), 1.0.into())) == (zero, [one, zero]));
    for power in [2, 3] {
        assert!(derivatives(Scalar::powi(at(zero), power)) == (zero, [zero; 2]));
    }
    assert!(derivatives(Scalar::tanh(at(T::int(800)))) == (one, [zero; 2]));
    assert!(derivatives(Scalar::sqrt(at(zero))) == (zero, [T::INFINITY, zero]));

    let tiny = T::exact(1e-110);
    let (f, g) = derivatives(Scalar::powi(at(tiny), -1));
    assert!((f * tiny - one).abs() < T::EPSILON * T::int(4));
    assert!((g[0] * tiny * tiny + one).abs() < T::EPSILON * T::int(8) && g[1] == zero);

    let axis = Scalar::atan2(at(one), T::Forward::<2>::variable(zero, 1));
    assert!(axis.gradient() == [zero, -one]);
}

#[test]
fn singular_points_have_limits() {
    singular_points::<f64>();
    singular_points::<Dd>();
}

#[test]
fn num_traits_agree_with_the_type() {
    use num_traits::{Bounded, FloatConst, FromPrimitive, Num as _, NumCast, ToPrimitive};
    assert_eq!(<Dd as num_traits::Float>::epsilon(), Dd::EPSILON);
    assert_eq!(<Dd as Bounded>::max_value(), Dd::MAX);
    assert_eq!(<Dd as num_traits::Float>::min_value(), -Dd::MAX);
    assert_eq!(
        <Dd as FromPrimitive>::from_u64(u64::MAX).and_then(|x| x.to_u64()),
        Some(u64::MAX)
    );
    assert_eq!(
        <Dd as FromPrimitive>::from_i128(-(1 << 100)).and_then(|x| x.to_i128()),
        Some(-(1 << 100))
    );
    assert_eq!(
        <Dd as NumCast>::from(u64::MAX - 1).and_then(|x| ToPrimitive::to_u64(&x)),
        Some(u64::MAX - 1)
    );
    assert_eq!(ToPrimitive::to_i64(&dd(-2.9)), Some(-2));
    assert_eq!(ToPrimitive::to_i64(&dd(1e19)), None);
    assert_eq!(<Dd as FloatConst>::PI(), Dd::PI);
    assert!(Dd::from_str_radix("11", 2).is_err());
    assert_eq!(Dd::from_str_radix("0.5", 10), Ok(dd(0.5)));
}

#[test]
fn approx_counts_in_units_of_double_double() {
    let x = Dd::PI;
    let near = x * (Dd::ONE + Dd::EPSILON * dd(3.0));
    let far = x * (Dd::ONE + Dd::EPSILON * dd(50.0));
    assert!(approx::ulps_eq!(x, near) && !approx::ulps_eq!(x, far));
    assert!(approx::relative_eq!(x, far, max_relative = dd(1e-29)));
    assert!(!approx::relative_eq!(x, dd(std::f64::consts::PI)));
    assert!(approx::abs_diff_eq!(x, x) && !approx::abs_diff_eq!(x, Dd::NAN));
    assert!(
        approx::relative_eq!(Dd::INFINITY, Dd::INFINITY) && !approx::relative_eq!(x, Dd::INFINITY)
    );
}

#[test]
fn expansions_and_constants_are_exact() {
    let mut random = Random(3);
    for _ in 0..10_000 {
        let x = random.log_uniform(-1000.0, 1000.0);
        let x = random.sign(x);
        assert_eq!(<Dd as Float>::from_expansion(x.expansion()), x);
        assert_eq!(Constant::from(x).to::<Dd>(), x);
    }
    assert!(<Dd as Float>::from_expansion([-0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).is_sign_negative());
    assert_eq!(
        <Dd as Float>::from_expansion([1.0, 1e-20, 1e-40, 1e-60, 0.0, 0.0]).lo(),
        1e-20
    );
    assert_eq!(
        <Dd as Float>::int(i64::MAX) - <Dd as Float>::int(i64::MAX - 1),
        Dd::ONE
    );
    assert_eq!(<Dd as Float>::ratio(1, 10), "0.1".parse().unwrap());
}
