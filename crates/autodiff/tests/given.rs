//! Gradients by hand beside a recorded energy: used in doubles, and held against the recording.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{BuildError, Hamiltonian, WrongGradient};
use equip_scalar::{DoubleDouble, Float};

/// ½p² + 2q², with `force` for ∂H/∂q.
fn spring(force: fn(f64) -> f64) -> Hamiltonian {
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0].powi(2) + 2.0 * q[0].powi(2)).unwrap();
    h.with_gradient(move |q, p, dq, dp| (dq[0], dp[0]) = (force(q[0]), p[0]))
}

#[test]
fn it_is_held_against_the_recording() {
    spring(|q| 4.0 * q).check_gradient(&[0.3, 0.7]).unwrap();
    let wrong = spring(|q| -4.0 * q);
    let found = wrong.check_gradient(&[0.5, 0.7]).unwrap_err();
    let (component, given, expected) = (0, -2.0, 2.0);
    assert_eq!(
        found,
        BuildError::WrongGradient {
            component,
            given,
            expected
        }
    );
    assert!(found.to_string().contains("component 0"), "{found}");
    let found = wrong.evaluator::<f64>().check_gradient(&[0.5, 0.7]);
    assert_eq!(
        found,
        Err(WrongGradient {
            component,
            given,
            expected
        })
    );
    let not_a_number = spring(|_| f64::NAN).check_gradient(&[1.0, 1.0]);
    assert!(matches!(
        not_a_number,
        Err(BuildError::WrongGradient { component: 0, .. })
    ));
    // Nothing to check.
    let recorded = Hamiltonian::new(1, |q, p| q[0] * p[0]).unwrap();
    recorded.check_gradient(&[1.0, 2.0]).unwrap();
}

/// Wherever ∇H is asked for, and nowhere else.
#[test]
fn it_serves_gradients() {
    let h = spring(|_| 7.0);
    let mut evaluator = h.evaluator::<f64>();
    let y = [0.5, 1.0];
    let mut gradient = [0.0; 2];
    assert_eq!(evaluator.gradient(&y, &mut gradient), 1.0);
    assert_eq!(gradient, [7.0, 1.0]);
    let mut several = [0.0; 4];
    evaluator.gradients(&[0.5, 1.0, 0.5, 2.0], &mut several, 2);
    assert_eq!(several, [7.0, 1.0, 7.0, 2.0]);
    evaluator.gradients_by_component(&[0.5, 0.5, 1.0, 2.0], &mut several, 2, 2);
    assert_eq!(several, [7.0, 7.0, 1.0, 2.0]);
    let mut forces = [0.0; 2];
    evaluator.forces_by_component(&[0.5, 0.6], &mut forces, 2, 2);
    assert_eq!(forces, [7.0; 2]);
    let mut hessian = [0.0; 2];
    evaluator.hessian(&y, &mut hessian);
    assert_eq!(hessian, [4.0, 1.0]);
    evaluator.hessian_vector(&y, &[1.0, 1.0], &mut hessian);
    assert_eq!(hessian, [4.0, 1.0]);
    assert!(evaluator.kinetic().is_some() && h.structure().is_quadratic());
    // The last one given is the one used.
    let other = h.with_gradient(|_, _, dq, dp| (dq[0], dp[0]) = (8.0, 9.0));
    other.evaluator().gradient(&y, &mut gradient);
    assert_eq!(gradient, [8.0, 9.0]);
}

#[test]
fn in_other_floats_the_recording_serves() {
    let h = spring(|_| 7.0);
    let mut gradient = [DoubleDouble::ZERO; 2];
    let mut evaluator = h.evaluator();
    let y = [DoubleDouble::ratio(1, 3), DoubleDouble::ONE];
    evaluator.gradient(&y, &mut gradient);
    assert_eq!(gradient, [y[0] * DoubleDouble::from(4.0), y[1]]);
    assert_eq!(evaluator.check_gradient(&y), Ok(()));
}

/// Of (q, t, p, p_t).
#[test]
fn with_time() {
    let pushed = Hamiltonian::with_time(1, |t, q, p| p[0] * p[0] / 2 - q[0] * t.cos()).unwrap();
    let by_hand = |push: f64| {
        pushed.clone().with_gradient(move |q, p, dq, dp| {
            dq.copy_from_slice(&[-q[1].cos(), push * q[0] * q[1].sin()]);
            dp.copy_from_slice(&[p[0], 1.0]);
        })
    };
    let y = [0.3, 0.1, 0.2, 0.0];
    by_hand(1.0).check_gradient(&y).unwrap();
    let found = by_hand(-1.0).check_gradient(&y);
    assert!(matches!(
        found,
        Err(BuildError::WrongGradient { component: 1, .. })
    ));
}

#[test]
#[should_panic = "a state of this system has 2 components"]
fn states_of_another_length() {
    spring(|q| q)
        .evaluator::<f64>()
        .gradients(&[1.0; 4], &mut [0.0; 4], 4);
}
