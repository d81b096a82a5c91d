//! Newton on system (7), stages and α's together, converges quadratically.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_scalar::{DoubleDouble, Float};
use equip_solver::{Alphas, Equip, Outcome};
use equip_tests::{Start, double_pendulum, kepler};

/// Runs of at least three corrections, each the square of the one before: the largest number in one step of
/// iterations in a row with log e_{k+1} / log e_k in 2 ± 0.25, and steps with three or more.
fn quadratic_runs(corrections: &[f64]) -> (usize, Vec<f64>) {
    let ratios: Vec<f64> = corrections
        .windows(2)
        .map(|e| e[1].ln() / e[0].ln())
        .collect();
    let mut best = 0;
    let mut run = 0;
    for (pair, ratio) in corrections.windows(2).zip(&ratios) {
        // Above 1e-2 the constant of the quadratic term hides the order, below 1e-29 rounding does.
        if pair[0] < 1e-1 && pair[1] > 1e-31 && (1.7..2.6).contains(ratio) {
            run += 1;
            best = best.max(run);
        } else {
            run = 0;
        }
    }
    (best, ratios)
}

fn converges_quadratically(
    name: &str,
    h: &Hamiltonian,
    start: &Start<DoubleDouble>,
    step: DoubleDouble,
    alphas: Alphas,
    s: usize,
) {
    let options = Equip::stages(s).alphas(alphas).step(step).pure_newton(true);
    let mut run = options
        .start(h, &start.q, &start.p, DoubleDouble::int(0))
        .unwrap();
    let mut steps_with_three = 0;
    for _ in 0..40 {
        let (index, outcome) = {
            let view = run.advance().unwrap();
            (view.index, view.outcome)
        };
        let history = run.newton_history();
        let corrections: Vec<f64> = history.iter().map(|r| r.correction.to_f64()).collect();
        let (best, ratios) = quadratic_runs(&corrections);
        if index <= 3 || index == 20 {
            println!("{name}, {alphas:?}, step {index}, {outcome:?}");
            for (r, ratio) in history.iter().zip([f64::NAN].iter().chain(&ratios)) {
                println!(
                    "  correction {:9.2e}  defect {:9.2e}  order {ratio:.2}",
                    r.correction, r.energy_defect
                );
            }
        }
        assert!(
            matches!(outcome, Outcome::Solved | Outcome::AtFloor),
            "{outcome:?}"
        );
        steps_with_three += usize::from(best >= 3);
    }
    println!("{name}: {steps_with_three} of 40 steps");
    assert!(steps_with_three >= 1);
}

#[test]
fn on_kepler() {
    let (h, start) = kepler::<DoubleDouble>(6);
    let step = DoubleDouble::two_pi() / DoubleDouble::int(80);
    for alphas in [Alphas::Last, Alphas::All] {
        converges_quadratically("Kepler", &h, &start, step, alphas, 3);
    }
}

#[test]
fn on_the_double_pendulum() {
    let (h, start) = double_pendulum::<DoubleDouble>();
    for alphas in [Alphas::Last, Alphas::All] {
        converges_quadratically(
            "double pendulum",
            &h,
            &start,
            DoubleDouble::ratio(1, 20),
            alphas,
            3,
        );
    }
}
