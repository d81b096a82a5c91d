//! What a run must keep to: its work, and what it says of the energy.

use super::case::{Case, Ran};
use equip_integrate::{AlphaPolicy, Outcome};
use equip_scalar::{DoubleDouble, Float};

/// No more work than the options allow: every step and every part of a halved one is tried with two norms
/// from two guesses, then with α = 0 from two.
pub(super) fn work_is_bounded(case: &Case, ran: &Ran) {
    let c = &ran.counts;
    let steps = c.steps + u64::from(ran.error.is_some());
    let parts = (2 << case.max_halvings) - 1;
    let iterations = steps * parts * 6 * 30;
    let s = case.stages as u64;
    assert!(c.fixed_point_iterations <= steps * parts * 2 * 80);
    // One for the correction, one for the columns of the α's.
    assert!(c.newton_iterations <= iterations && c.factorisations <= 2 * c.newton_iterations);
    assert!(c.gradients <= iterations * (8 * s + 2));
    assert!(
        c.alpha_updates <= steps * parts * 30 && c.directions <= c.alpha_updates + steps * parts
    );
    assert!(c.local_errors <= steps * parts);
    assert!(c.halvings <= steps * (parts / 2));
    assert_eq!(c.steps, ran.seen.len() as u64);
    let outcomes: u64 = Outcome::ALL.iter().map(|&o| c.outcome(o)).sum();
    assert_eq!(outcomes, c.steps);
}

/// The solver's claims about the energy, checked with H in double-double at the very same states.
///
/// Returns the largest |H(y) − H(y0)| in floors over the steps that claim to have kept it.
pub(super) fn energy_is_as_claimed(case: &Case, ran: &Ran) -> f64 {
    let hamiltonian = &case.system.hamiltonian;
    let (mut in_f64, mut in_dd) = (
        hamiltonian.evaluator::<f64>(),
        hamiltonian.evaluator::<DoubleDouble>(),
    );
    let mut at = |y: &[f64]| {
        let exact = in_dd.value(
            &y.iter()
                .map(|&x| DoubleDouble::exact(x))
                .collect::<Vec<_>>(),
        );
        let noise = (DoubleDouble::exact(in_f64.value(y)) - exact)
            .to_f64()
            .abs();
        (exact, noise)
    };
    let (h0, noise0) = at(&case.system.start);
    let quadratic = hamiltonian.structure().is_quadratic();
    let mut gradient = vec![0.0; case.system.start.len()];
    let mut evaluator = hamiltonian.evaluator::<f64>();
    let mut largest = 0.0_f64;
    let mut quadratic_floor = 0.0_f64;
    for seen in &ran.seen {
        assert!(seen.y.iter().all(|y| y.is_finite()), "state {:?}", seen.y);
        let (h, noise) = at(&seen.y);
        let (defect, noise) = ((h - h0).to_f64().abs(), noise + noise0);
        if !noise.is_finite() {
            assert!(
                !seen.outcome.energy_conserved(),
                "{:?} where H is infinite",
                seen.outcome
            );
            continue;
        }
        // What is reported is what is there, whatever the outcome.
        let (reported, slack) = (seen.defect.abs(), noise + 1e-12 * (noise + defect));
        assert!(
            (reported - defect).abs() <= slack,
            "reported {reported:e}, found {defect:e}, noise {noise:e}"
        );
        if quadratic {
            assert_eq!(seen.outcome, Outcome::Quadratic, "a quadratic H");
            let value = evaluator.gradient(&seen.y, &mut gradient);
            let scale = gradient
                .iter()
                .zip(&seen.y)
                .fold(value.abs(), |sum, (g, y)| sum + (g * y).abs());
            quadratic_floor = quadratic_floor.max(f64::EPSILON * scale);
            largest = largest.max(defect / (quadratic_floor + noise));
        } else if seen.outcome.energy_conserved() {
            let floor = seen.floor.unwrap();
            assert!(
                defect <= 8.0 * floor + noise,
                "{:?}: |H - H0| = {defect:e}, floor {floor:e}, noise {noise:e}",
                seen.outcome
            );
            if floor > 0.0 {
                largest = largest.max(defect / floor);
            }
        } else {
            assert!(seen.outcome.is_uncorrected());
            assert_eq!(case.alpha_policy, AlphaPolicy::WithinError);
        }
        assert!(
            seen.alphas.iter().all(|a| a.abs() <= 0.05 * (1.0 + 1e-12)),
            "alphas {:?}",
            seen.alphas
        );
        if seen.outcome == Outcome::AtRoundOff {
            assert!(
                seen.alphas.iter().all(|a| *a == 0.0),
                "alphas {:?}",
                seen.alphas
            );
        }
    }
    largest
}
