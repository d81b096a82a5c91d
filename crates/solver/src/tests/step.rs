//! Properties of a step other than the solution of its equations.

use crate::constraint::Constraint;
use crate::options::family::{Alphas, Family};
use crate::options::invariant::Invariant;
use crate::options::step_options::{AlphaPolicy, StepOptions};
use crate::outcome::outcome::Outcome;
use crate::step::core::Core;
use equip_autodiff::Hamiltonian;
use equip_iterate::State;
use equip_tableau::Coefficients;

/// A body around a centre at (1000, 0).
fn far_kepler() -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        let x = q[0] - 1000.0;
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (x * x + q[1] * q[1]).sqrt()
    })
    .unwrap()
}

fn core(
    h: &Hamiltonian,
    s: usize,
    (alpha_policy, constraint): (AlphaPolicy, Constraint<f64>),
    y: &[f64],
) -> Core<f64> {
    let options = StepOptions {
        alpha_policy,
        ..StepOptions::new(s, Family::Equip(Alphas::Several))
    };
    let mut evaluator = h.evaluator::<f64>();
    let h_ref = evaluator.compensated_value(y);
    let gauss = Coefficients::gauss(s).unwrap();
    let mut core = Core::new(h, evaluator, options, gauss, vec![constraint]);
    core.begin(h_ref, y);
    core
}

/// Energy errors of a few round-off levels that no α reduces are rounding, whether or not uncorrected steps
/// are rejected.
#[test]
fn rounding_is_not_refused() {
    let h = far_kepler();
    let start = [1000.7, 0.0, 0.0, (1.3_f64 / 0.7).sqrt()];
    let mut outcomes = [Vec::new(), Vec::new()];
    for (alpha_policy, outcomes) in [AlphaPolicy::WithinError, AlphaPolicy::Refuse]
        .into_iter()
        .zip(&mut outcomes)
    {
        let mut core = core(&h, 2, (alpha_policy, Constraint::energy(4)), &start);
        let mut y = State::new(&start, &[]);
        let mut next = y.clone();
        for _ in 0..2000 {
            outcomes.push(core.step(&y, 0.0, 0.003, &mut next));
            std::mem::swap(&mut y, &mut next);
        }
        assert!(core.counts.alpha_updates > 20, "{:?}", core.counts);
    }
    let conserved = |x: &Result<Outcome, _>| x.is_ok_and(Outcome::energy_conserved);
    assert!(outcomes[0].iter().all(conserved));
    assert!(outcomes[0].contains(&Ok(Outcome::AtRoundOff)));
    assert_eq!(outcomes[0], outcomes[1]);
}

/// A step that fails does not change the recent round-off levels.
#[test]
fn a_step_that_fails_forgets_no_floor() {
    let h = far_kepler();
    let start = [1000.7, 0.0, 0.0, (1.3_f64 / 0.7).sqrt()];
    let mut core = core(
        &h,
        4,
        (AlphaPolicy::WithinError, Constraint::energy(4)),
        &start,
    );
    let y = State::new(&start, &[]);
    let mut next = y.clone();
    core.step(&y, 0.0, 0.01, &mut next).unwrap();
    let late = core.constraints[0].late;
    assert!(late > 0.0);
    core.step(&y, 0.0, f64::MAX, &mut next).unwrap_err();
    assert_eq!(core.constraints[0].late, late);
}

/// Neither do its parts that were accepted.
#[test]
fn a_step_that_fails_in_its_second_half_leaves_the_floors() {
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + (1.0 - q[0]).sqrt()).unwrap();
    let start = [0.0, 1.0];
    let mut core = core(
        &h,
        4,
        (AlphaPolicy::WithinError, Constraint::energy(2)),
        &start,
    );
    let y = State::new(&start, &[]);
    let mut next = y.clone();
    core.step(&y, 0.0, 0.01, &mut next).unwrap();
    let late = core.constraints[0].late;
    core.step(&y, 0.0, 4.0, &mut next).unwrap_err();
    assert!(core.failed_part().time > 0.0, "{:?}", core.failed_part());
    assert_eq!(core.constraints[0].late, late);
}

/// The initial guess of the stages uses the derivative by the energy, whatever is conserved.
#[test]
fn the_gradient_of_an_invariant_is_none_of_the_energy() {
    let h = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1])
    });
    let h = h.unwrap();
    let momentum = Hamiltonian::new(2, |q, p| (q[0] * p[1] - q[1] * p[0]).sin());
    let momentum = Invariant::new("sin L", momentum.unwrap());
    let start = [0.3, 0.1, -0.2, 0.9];
    let mut iterations = [0; 2];
    let kept = [Constraint::energy(4), Constraint::invariant(&momentum, 4)];
    for (constraint, iterations) in kept.into_iter().zip(&mut iterations) {
        let mut core = core(&h, 6, (AlphaPolicy::WithinError, constraint), &start);
        let mut y = State::new(&start, &[]);
        let mut next = y.clone();
        for _ in 0..50 {
            assert_eq!(core.step(&y, 0.0, 0.1, &mut next), Ok(Outcome::AtRoundOff));
            std::mem::swap(&mut y, &mut next);
        }
        *iterations = core.counts.fixed_point_iterations;
    }
    assert!(iterations[1] <= iterations[0] + 50, "{iterations:?}");
}
