//! The macro, and hand-written gradients.

use equip_autodiff::{BuildError, Energy, Evaluate, Hamiltonian, System, hamiltonian};
use equip_scalar::{DoubleDouble, Float, Num, Scalar, decimal, ratio};

fn value<H: System>(h: &H, y: &[f64]) -> f64 {
    h.evaluator::<f64>().value(y)
}

#[test]
fn parameters_of_every_kind() {
    let mu = 3.0;
    let by_name = hamiltonian!(1; mu; |q, p| mu * mu * q[0] + p[0] / mu).unwrap();
    assert_eq!(value(&by_name, &[2.0, 6.0]), 20.0);
    let given =
        hamiltonian!(1; a = mu + 1.0, b = ratio(1, 4), c = 2; |q, p| a * b * q[0] + c * p[0]);
    assert_eq!(value(&given.unwrap(), &[2.0, 6.0]), 14.0);
    let exact = decimal("0.1").unwrap();
    let wide = DoubleDouble::ratio(1, 3);
    let mixed = hamiltonian!(1; exact, wide, n: i32 = 3, masses: [f64; 2] = [1.0, 2.0],; |q, p| {
        (exact - wide).sqrt() * 0.0 + (masses[0] + masses[1]) * q[0].powi(n) + p[0] * exact
    });
    // √(0.1 − 1/3) is NaN already while H is built.
    assert!(matches!(mixed, Err(BuildError::ConstantNotANumber)));
    let mixed = hamiltonian!(1; exact, wide, n: i32 = 3, masses: [f64; 2] = [1.0, 2.0],; |q, p| {
        (masses[0] + masses[1]) * q[0].powi(n) + 3.0 * p[0] * wide + exact
    });
    assert_eq!(value(&mixed.unwrap(), &[2.0, 5.0]), 29.1);
    let size = 4;
    let none = hamiltonian!(size; |q, p| q[0] * p[3]).unwrap();
    assert_eq!(none.degrees_of_freedom(), 4);
    assert!(matches!(
        hamiltonian!(0, |_q, _p| Num::from(1.0)),
        Err(BuildError::NoDegreesOfFreedom)
    ));
}

#[test]
fn parameters_keep_their_digits() {
    let third = DoubleDouble::ratio(1, 3);
    let tenth = decimal("0.1").unwrap();
    let h = hamiltonian!(1; third, tenth; |q, p| third * q[0] + tenth * p[0]).unwrap();
    let recorded = Hamiltonian::new(1, |q, p| third * q[0] + tenth * p[0]).unwrap();
    let y = [DoubleDouble::int(3), DoubleDouble::int(10)];
    let mut gradient = [DoubleDouble::int(0); 2];
    // 2 units in the last of 31 digits; with 1/3 or 1/10 as a double the error would be 2e-17.
    let allowed = DoubleDouble::EPSILON + DoubleDouble::EPSILON;
    for h in [
        h.evaluator().gradient(&y, &mut gradient),
        recorded.evaluator().value(&y),
    ] {
        assert!((h - DoubleDouble::int(2)).abs() <= allowed, "{h}");
    }
    assert_eq!(
        gradient,
        [DoubleDouble::ratio(1, 3), DoubleDouble::ratio(1, 10)]
    );
    let capped = Hamiltonian::new(1, |q, _| 0.1 * q[0]).unwrap();
    let error = capped.evaluator().value(&[DoubleDouble::int(10); 2]) - DoubleDouble::int(1);
    assert!(
        error.to_f64() > 5e-17,
        "the literal 0.1 is the double: {error:e}"
    );
}

struct ByHand {
    stiffness: f64,
    slope_is_right: bool,
}

impl Energy for ByHand {
    fn degrees_of_freedom(&self) -> usize {
        1
    }
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        0.5 * p[0].powi(2) + 0.5 * self.stiffness * q[0].powi(2)
    }
    fn gradient<T: Float>(&self, q: &[T], p: &[T], dq: &mut [T], dp: &mut [T]) -> bool {
        let factor = T::exact(self.stiffness) * T::int(if self.slope_is_right { 1 } else { -1 });
        (dq[0], dp[0]) = (factor * q[0], p[0]);
        true
    }
}

#[test]
fn a_hand_written_gradient_wins_and_is_checked() {
    let right = Hamiltonian::from_energy(ByHand {
        stiffness: 4.0,
        slope_is_right: true,
    })
    .unwrap();
    right.check_gradient(&[0.3, 0.7]).unwrap();
    right
        .check_gradient(&[DoubleDouble::ratio(1, 3), DoubleDouble::int(1)])
        .unwrap();
    let wrong = Hamiltonian::from_energy(ByHand {
        stiffness: 4.0,
        slope_is_right: false,
    })
    .unwrap();
    let error = wrong.check_gradient(&[0.5, 0.7]).unwrap_err();
    assert_eq!(
        error,
        BuildError::WrongGradient {
            component: 0,
            given: -2.0,
            expected: 2.0
        }
    );
    assert!(error.to_string().contains("component 0"), "{error}");
    let mut gradient = [0.0; 2];
    assert_eq!(
        wrong
            .evaluator::<f64>()
            .gradient(&[0.5, 1.0], &mut gradient),
        1.0
    );
    assert_eq!(gradient, [-2.0, 1.0]);
    wrong
        .evaluator::<f64>()
        .gradients(&[0.5, 1.0], &mut gradient, 2);
    assert_eq!(gradient, [-2.0, 1.0]);
    // Nothing to check.
    hamiltonian!(1, |q, p| q[0] * p[0])
        .unwrap()
        .check_gradient(&[1.0, 2.0])
        .unwrap();
}

#[test]
fn a_supplied_gradient_serves_doubles_only() {
    let recorded = Hamiltonian::new(1, |q, p| q[0].powi(2) + p[0].powi(2)).unwrap();
    let supplied = recorded.with_gradient(|q, p, dq, dp| {
        dq[0] = 7.0 * q[0];
        dp[0] = 7.0 * p[0];
    });
    let mut gradient = [0.0; 2];
    assert_eq!(
        supplied.evaluator().gradient(&[1.0, 2.0], &mut gradient),
        5.0
    );
    assert_eq!(gradient, [7.0, 14.0]);
    let mut wide = [DoubleDouble::int(0); 2];
    let y = [DoubleDouble::int(1), DoubleDouble::int(2)];
    supplied.evaluator().gradient(&y, &mut wide);
    assert_eq!(wide, [DoubleDouble::int(2), DoubleDouble::int(4)]);
    let found = supplied.check_gradient(&[1.0, 2.0]);
    assert!(matches!(
        found,
        Err(BuildError::WrongGradient { component: 0, .. })
    ));
    let not_finite = Hamiltonian::new(1, |q, p| q[0] + p[0])
        .unwrap()
        .with_gradient(|_, _, dq, dp| (dq[0], dp[0]) = (1.0, f64::NAN))
        .check_gradient(&[1.0, 1.0]);
    assert!(matches!(
        not_finite,
        Err(BuildError::WrongGradient { component: 1, .. })
    ));
}
