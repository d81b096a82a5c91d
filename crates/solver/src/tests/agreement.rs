//! Comparison of the solver with the reference solution: one step from the same state, with each
//! preconditioner.

use crate::constraint::Constraint;
use crate::options::family::{Alphas, Family};
use crate::options::step_options::{Preconditioner, StepOptions};
use crate::outcome::outcome::Outcome;
use crate::step::core::Core;
use crate::tests::oracle::Oracle;
use equip_autodiff::{Hamiltonian, Var};
use equip_iterate::State;
use equip_scalar::{DoubleDouble, Float};
use equip_tableau::Coefficients;

const ALL: [Preconditioner; 5] = [
    Preconditioner::Automatic,
    Preconditioner::Identity,
    Preconditioner::Diagonal,
    Preconditioner::Frozen,
    Preconditioner::Full,
];

/// One step from `y` with each preconditioner and by the reference. The outcomes must agree. The end points
/// must agree to `most` ε of the largest component, plus the share of the displacement that the tolerance of
/// D permits.
fn compare<T: Float>(
    name: &str,
    h: &Hamiltonian,
    y: &[f64],
    (s, step): (usize, f64),
    most: f64,
) -> Outcome {
    let y: Vec<T> = y.iter().map(|&x| T::exact(x)).collect();
    let (gauss, step) = (Coefficients::<T>::gauss(s).unwrap(), T::exact(step));
    let h_ref = h.evaluator::<T>().compensated_value(&y);
    let options = StepOptions::<T>::new(s, Family::Equip(Alphas::Several));
    let mut oracle = Oracle::new(h, h_ref, options.alpha_bound);
    let expected = oracle.step(&gauss, &y, step, T::int(0)).unwrap();
    let mut gauss_step = Core::new(
        h,
        h.evaluator::<T>(),
        StepOptions::<T>::new(s, Family::Gauss),
        gauss.clone(),
        Vec::new(),
    );
    gauss_step.begin(h_ref, &y);
    let (start, mut unperturbed) = (State::new(&y, &[]), State::new(&y, &[]));
    let made = gauss_step.step(&start, T::int(0), step, &mut unperturbed);
    made.unwrap_or_else(|e| panic!("{name}, s = {s}, Gauss: {e}"));
    let ends = expected.end.iter().zip(&unperturbed.hi);
    let displacement = ends.fold(T::int(0), |a, (&x, &y)| a.max((x - y).abs()));
    let ends = expected.end.iter().zip(&y);
    let motion = ends.fold(T::int(0), |a, (&x, &y)| a.max((x - y).abs()));
    // The relative error of D.
    let turn = (displacement / motion).min(T::ratio(1, 1000));
    let turn = turn.max(T::int(64) * T::EPSILON.sqrt());
    let size = y
        .iter()
        .chain(&expected.end)
        .fold(T::int(0), |a, x| a.max(x.abs()));
    for preconditioner in ALL {
        let options = StepOptions {
            preconditioner,
            ..options.clone()
        };
        let constraint = Constraint::energy(y.len());
        let mut core = Core::new(
            h,
            h.evaluator::<T>(),
            options,
            gauss.clone(),
            vec![constraint],
        );
        core.begin(h_ref, &y);
        let start = State::new(&y, &[]);
        let mut next = start.clone();
        let outcome = core.step(&start, T::int(0), step, &mut next);
        let outcome =
            outcome.unwrap_or_else(|e| panic!("{name}, s = {s}, {preconditioner:?}: {e}"));
        assert_eq!(
            outcome, expected.outcome,
            "{name}, s = {s}, {preconditioner:?}"
        );
        for (&found, &wanted) in next.hi.iter().zip(&expected.end) {
            let allowed = T::exact(most) * T::EPSILON * size + T::int(4) * turn * displacement;
            let off = ((found - wanted).abs() / allowed).to_f64();
            assert!(
                off <= 1.0,
                "{name}, s = {s}, {preconditioner:?}: {off} times what is allowed"
            );
        }
        for (&found, &wanted) in core.alphas().iter().zip(&expected.alphas) {
            // An α_k is determined by its effect on the end point, to the accuracy of the end point.
            assert!(
                (found - wanted).abs() <= T::ratio(1, 100) * wanted.abs().max(T::EPSILON.sqrt()),
                "{name}: {found}, {wanted}"
            );
        }
    }
    expected.outcome
}

/// Name, energy, initial state, and stages with step sizes.
type Case = (&'static str, Hamiltonian, Vec<f64>, Vec<(usize, f64)>);

fn systems() -> Vec<Case> {
    let kepler = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    });
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos());
    let swinging = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos());
    let henon = Hamiltonian::new(2, |q, p| {
        let square = q[0] * q[0] + q[1] * q[1] + p[0] * p[0] + p[1] * p[1];
        0.5 * square + q[0] * q[0] * q[1] - q[1].powi(3) / 3.0
    });
    let coupled = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1])
            + 0.3 * p[0] * q[1].sin()
            + 0.25 * (q[0] * q[0] + q[1] * q[1]).powi(2)
    });
    let ring = Hamiltonian::new(4, |q, p| {
        let at = |i: usize| 0.5 * p[i] * p[i] - (q[(i + 1) % 4] - q[i]).cos();
        (0..4).map(at).sum::<Var>()
    });
    // On se(3)*: y = (m, γ), m' = m × ω + γ × ∂H/∂γ, γ' = γ × ω.
    let top = Hamiltonian::of_state(6, |y| {
        let kinetic = 0.5 * (y[0].powi(2) + y[1].powi(2) / 1.5 + y[2].powi(2) / 2.0);
        kinetic + y[5] + 0.2 * y[3] + 0.25 * y[3].powi(4)
    });
    let top = top.and_then(|top| {
        top.with_bracket(|y| {
            vec![
                (0, 1, -y[2]),
                (0, 2, y[1]),
                (1, 2, -y[0]),
                (0, 4, -y[5]),
                (0, 5, y[4]),
                (1, 5, -y[3]),
                (1, 3, y[5]),
                (2, 3, -y[4]),
                (2, 4, y[3]),
            ]
        })
    });
    vec![
        (
            "heavy top",
            top.unwrap(),
            vec![0.4, -0.3, 1.2, 0.6, 0.0, 0.8],
            vec![(4, 0.25), (6, 0.5)],
        ),
        (
            "Kepler",
            kepler.unwrap(),
            vec![0.4, 0.0, 0.0, 2.0],
            vec![(4, 0.1), (6, 0.2), (3, 0.05)],
        ),
        (
            "pendulum",
            pendulum.unwrap(),
            vec![1.3, 0.9],
            vec![(2, 0.1), (4, 0.3), (6, 0.6)],
        ),
        (
            "pendulum, hω beyond s",
            swinging.unwrap(),
            vec![0.3, 0.2],
            vec![(2, 2.1), (3, 3.2)],
        ),
        (
            "Hénon–Heiles",
            henon.unwrap(),
            vec![0.0, 0.1, 0.5, 0.1],
            vec![(4, 0.5), (6, 1.0), (8, 0.25)],
        ),
        (
            "coupled",
            coupled.unwrap(),
            vec![0.5, -0.8, 0.3, 0.6],
            vec![(3, 0.2), (5, 0.4)],
        ),
        (
            "ring",
            ring.unwrap(),
            vec![0.1, 1.9, 2.7, 0.6, 1.2, -0.7, 0.4, 0.9],
            vec![(4, 0.2), (6, 0.4)],
        ),
    ]
}

/// Measured: at most 40 ε, and for corrected steps 2e3 ε if the displacement is 1e-4 (differences of ∇H), in
/// addition to the error of D; the bound is 5 times that. Steps backward in time solve the same equations
/// with h < 0. They start with reversed momenta, which gives the same motion if H is even in p.
#[test]
fn every_preconditioner_solves_the_equations() {
    for sign in [1.0, -1.0] {
        let mut solved = 0;
        for (name, h, mut y, settings) in systems() {
            let m = y.len() / 2;
            y[m..].iter_mut().for_each(|p| *p *= sign);
            for (s, step) in settings {
                let outcome = compare::<f64>(name, &h, &y, (s, sign * step), 1e4);
                solved += usize::from(outcome == Outcome::Solved);
                assert_eq!(
                    outcome == Outcome::Unresolved,
                    name.contains("beyond"),
                    "{name}, s = {s}"
                );
            }
        }
        assert!(solved >= 6, "{solved} steps with α");
    }
}

/// The same equations in double-double, beyond the precision of `f64`.
#[test]
fn the_same_in_double_double() {
    for (name, h, y, settings) in systems() {
        compare::<DoubleDouble>(name, &h, &y, settings[0], 1e6);
    }
}
