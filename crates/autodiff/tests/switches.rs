//! Known switches: what is piecewise in H, as functions that change their sign there.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use crate::common::widened;
use equip_autodiff::SwitchKind::{Absolute, Extremum, Selection, Sign};
use equip_autodiff::{Hamiltonian, SwitchKind, Var};
use equip_scalar::DoubleDouble;

/// Kinds, and values at (q, p) = (1, 3), in doubles; those in double-double are the same.
fn at_one_and_three(energy: impl FnOnce(&[Var], &[Var]) -> Var) -> (Vec<SwitchKind>, Vec<f64>) {
    let switches = Hamiltonian::new(1, energy).unwrap().switches();
    let y = [1.0, 3.0];
    let mut g = vec![f64::NAN; switches.len()];
    switches.evaluator().values(&y, &mut g);
    let mut wide = vec![DoubleDouble::NAN; switches.len()];
    switches.evaluator().values(&widened(&y), &mut wide);
    assert_eq!(widened(&g), wide);
    (switches.kinds().to_vec(), g)
}

#[test]
fn one_of_each_kind() {
    assert_eq!(
        at_one_and_three(|q, p| (q[0] - 4).abs() + p[0]),
        (vec![Absolute], vec![-3.0])
    );
    assert_eq!(
        at_one_and_three(|q, p| q[0].min(p[0])),
        (vec![Extremum], vec![-2.0])
    );
    assert_eq!(
        at_one_and_three(|q, p| q[0].clamp(-1, 2) + p[0]),
        (vec![Extremum; 2], vec![2.0, -1.0])
    );
    assert_eq!(
        at_one_and_three(|q, p| (q[0] - p[0]).select(q[0], p[0]) + q[0].signum()),
        (vec![Selection, Sign], vec![-2.0, 1.0])
    );
}

/// Equal ones once; what is constant, or is left out of H, not at all.
#[test]
fn only_what_matters() {
    let (kinds, g) = at_one_and_three(|q, p| {
        let _ = (q[0] + p[0]).abs();
        let constant = Var::from(-3).abs().max(1);
        q[0].abs() * q[0].abs() + q[0].abs().powi(3) + constant
    });
    assert_eq!((kinds, g), (vec![Absolute], vec![1.0]));
    let smooth = Hamiltonian::new(1, |q, p| p[0] * p[0] - q[0].cos()).unwrap();
    assert!(smooth.switches().is_empty());
    smooth.switches().evaluator().values(&[0.0, 0.0], &mut []);
}

/// Below one sign of every switch H is smooth: values of a kinked function from pieces that are told apart
/// by nothing but its switches.
#[test]
fn signs_say_which_piece_is_taken() {
    let h = Hamiltonian::new(1, |q, p| {
        let x = q[0];
        p[0] + x.abs() + (x - 1).max(0) * 2 + (x + 2).select(0, x * x)
    });
    let mut evaluator = h.as_ref().unwrap().evaluator::<f64>();
    let switches = h.as_ref().unwrap().switches();
    let mut of_switches = switches.evaluator();
    let mut g = [0.0; 3];
    for i in 0..60 {
        let x = 0.1 * f64::from(i) - 3.05;
        of_switches.values(&[x, 0.0], &mut g);
        let sign = |g: f64| if g >= 0.0 { 1.0 } else { 0.0 };
        let slope = 2.0 * sign(g[0]) - 1.0 + 2.0 * sign(g[1]);
        let expected = slope + 2.0 * x * (1.0 - sign(g[2]));
        let mut gradient = [0.0; 2];
        evaluator.gradient(&[x, 0.0], &mut gradient);
        assert!((gradient[0] - expected).abs() < 1e-14, "{x}");
    }
}

/// With a gradient by hand they are those of H.
#[test]
fn with_a_gradient_by_hand() {
    let wall = Hamiltonian::new(1, |q, p| p[0] * p[0] + q[0].max(0).powi(2)).unwrap();
    assert_eq!(wall.switches().kinds(), [Extremum]);
    let by_hand = wall.with_gradient(|q, p, dq, dp| {
        (dq[0], dp[0]) = (2.0 * q[0].max(0.0), 2.0 * p[0]);
    });
    assert_eq!(by_hand.switches().kinds(), [Extremum]);
}

#[test]
#[should_panic = "one place for each switch"]
fn places_are_counted() {
    let h = Hamiltonian::new(1, |q, _| q[0].abs()).unwrap();
    h.switches().evaluator().values(&[0.0, 0.0], &mut []);
}
