//! Closures in an energy.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{DoubleDouble, Float};
use equip_tables::{Custom, TableError};

/// tan x/2, by itself.
fn closures() -> Custom {
    Custom::new(
        |x| 0.5 * x.tan(),
        |x| 0.5 + 0.5 * x.tan().powi(2),
        |x| x.tan() * (1.0 + x.tan().powi(2)),
    )
}

/// H, ∇H, ∇²H of a system with one degree of freedom.
fn all<T: Float>(h: &Hamiltonian, y: [T; 2]) -> [T; 7] {
    let mut evaluator = h.evaluator::<T>();
    let mut found = [T::int(0); 7];
    let (values, columns) = found.split_at_mut(3);
    values[0] = evaluator.gradient(&y, &mut values[1..]);
    for (k, column) in columns.chunks_exact_mut(2).enumerate() {
        let mut v = [T::int(0); 2];
        v[k] = T::int(1);
        evaluator.hessian_vector(&y, &v, column);
    }
    found
}

fn beside(custom: impl Fn(Var, Var) -> Var, written: impl Fn(Var, Var) -> Var) -> [f64; 2] {
    let custom = Hamiltonian::new(1, |q, p| custom(q[0], p[0])).unwrap();
    let written = Hamiltonian::new(1, |q, p| written(q[0], p[0])).unwrap();
    let y = [0.4, -0.3];
    let wide = y.map(|x| DoubleDouble::from(x) + DoubleDouble::from(1e-18));
    let (found, expected) = (all(&custom, y), all(&written, y));
    let errors = found.iter().zip(&expected).map(|(x, y)| (x - y).abs());
    let (found, expected) = (all(&custom, wide), all(&written, wide));
    let wide_errors = (found.iter().zip(&expected)).map(|(&x, &y)| (x - y).abs().hi());
    [errors.fold(0.0, f64::max), wide_errors.fold(0.0, f64::max)]
}

/// Measured: 2e-16 and, of closures for doubles, 2e-16 in double-double too.
#[test]
fn as_the_same_function_written_out() {
    let f = closures();
    let errors = beside(
        |q, p| p * p / 2 + f.at(q * p) * q,
        |q, p| p * p / 2 + (q * p).tan() / 2 * q,
    );
    assert!(errors.iter().all(|&e| e < 1e-15), "{errors:?}");
    let wide = Custom::new(|x| x.sin(), |x| x.cos(), |x| -x.sin()).in_double_double(
        |x| x.sin(),
        |x| x.cos(),
        |x| -x.sin(),
    );
    let errors = beside(|q, p| wide.at(q * p) + p, |q, p| (q * p).sin() + p);
    assert!(errors[0] < 1e-15 && errors[1] < 1e-30, "{errors:?}");
}

/// f′ within H, whose Hessian asks for f‴: a difference of f″, to ten digits.
#[test]
fn third_derivatives_by_differences() {
    let f = closures();
    let errors = beside(
        |q, p| f.derivative_at(q) * p,
        |q, p| (1 + q.tan().powi(2)) / 2 * p,
    );
    assert!(errors.iter().all(|&e| e < 1e-9), "{errors:?}");
    assert!(errors[0] > 1e-15);
}

/// Two closures of one shape are two functions.
#[test]
fn each_is_its_own() {
    let [one, two] = [1.0, 2.0].map(|c| Custom::new(move |x| c * x, move |_| c, |_| 0.0));
    let copy = one.clone();
    let h = Hamiltonian::new(1, |q, p| one.at(q[0]) - copy.at(q[0]) + two.at(p[0])).unwrap();
    let mut gradient = [0.0; 2];
    assert_eq!(h.evaluator().gradient(&[3.0, 5.0], &mut gradient), 10.0);
    assert_eq!(gradient, [0.0, 2.0]);
    // one(q), q − q, two(p), and their sum.
    assert_eq!(h.operations(), 4);
}

#[test]
fn wrong_derivatives_are_named() {
    assert_eq!(closures().check(0.3), Ok(()));
    let small = Custom::new(|x| 1e-3 * x.cos(), |x| -1e-3 * x.sin(), |x| -1e-3 * x.cos());
    assert_eq!(small.check(1e3), Ok(()));
    let second = Custom::new(|x| x.powi(4), |x| 4.0 * x.powi(3), |x| 12.0 * x);
    let found = second.check(0.5);
    assert!(matches!(
        found,
        Err(TableError::WrongDerivative {
            order: 2,
            given: 6.0,
            ..
        })
    ));
    let text = found.unwrap_err().to_string();
    assert!(
        text.starts_with("at 5e-1 derivative 2 of the function is 6e0"),
        "{text}"
    );
    let nan = Custom::new(|_| f64::NAN, |x| x, |_| 1.0);
    assert!(nan.check(0.5).is_err());
}
