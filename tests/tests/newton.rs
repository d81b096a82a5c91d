//! Newton on system (7), stages and α's together, converges quadratically.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Alphas, Equip, NewtonRecord, Outcome};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::{Start, double_pendulum, kepler};

/// Errors of the iterates: the larger of the stage correction still wanted and the energy defect (H is of size 1).
fn errors(history: &[NewtonRecord<DoubleDouble>]) -> Vec<f64> {
    history
        .iter()
        .map(|r| r.correction.max(r.energy_defect.abs()).to_f64())
        .collect()
}

/// The constants C_k = e_{k+1}/e_k² of the longest tail of iterations along which they stay within a factor 300 of
/// each other: C_k is bounded if convergence is quadratic, and grows like 1/e_k if it is linear.
fn quadratic_tail(errors: &[f64]) -> Vec<f64> {
    // Below 1e-30 an error is rounding.
    let clean: Vec<f64> = errors.iter().copied().take_while(|e| *e > 1e-30).collect();
    let constants: Vec<f64> = clean.windows(2).map(|e| e[1] / (e[0] * e[0])).collect();
    let mut tail = Vec::new();
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for &c in constants.iter().rev() {
        (low, high) = (low.min(c), high.max(c));
        if high > 300.0 * low {
            break;
        }
        tail.insert(0, c);
    }
    tail
}

fn shown(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:.1e} ")).collect()
}

/// 40 steps: how many solve for the energy with three and more such iterations in a row, the last below 1e-20.
fn quadratic_steps(
    name: &str,
    energy: &Hamiltonian,
    start: &Start<DoubleDouble>,
    h: DoubleDouble,
    alphas: Alphas,
) -> usize {
    let options = Equip::stages(3).alphas(alphas).step(h).pure_newton(true);
    let mut run = options
        .start(energy, &start.q, &start.p, DoubleDouble::int(0))
        .unwrap();
    let mut good = 0;
    for _ in 0..40 {
        let view = run.advance().unwrap();
        let (index, outcome) = (view.index, view.outcome);
        let errors = errors(run.newton_history());
        let tail = quadratic_tail(&errors);
        let least = errors
            .iter()
            .copied()
            .filter(|e| *e > 1e-30)
            .fold(1.0, f64::min);
        if outcome == Outcome::Solved && tail.len() >= 3 && least < 1e-20 {
            good += 1;
            if good <= 2 {
                let orders: Vec<f64> = errors.windows(2).map(|e| e[1].ln() / e[0].ln()).collect();
                println!("{name}, {alphas:?}, step {index}: {}", shown(&errors));
                println!(
                    "  log e_(k+1)/log e_k {orders:.2?}, e_(k+1)/e_k^2 {}",
                    shown(&tail)
                );
            }
        }
    }
    let counts = run.counts();
    assert_eq!(
        counts.factorisations, counts.newton_iterations,
        "every iteration is a Newton step"
    );
    println!("{name}, {alphas:?}: {good} of 40 steps");
    good
}

#[test]
fn on_kepler() {
    let (energy, start) = kepler(6);
    for alphas in [Alphas::Last, Alphas::All] {
        let steps = quadratic_steps(
            "Kepler",
            &energy,
            &start,
            DoubleDouble::ratio(3, 10),
            alphas,
        );
        // Measured 8 and 7; the steps that start nearer to their solution have no three iterations to show.
        assert!(steps >= 4);
    }
}

#[test]
fn on_the_double_pendulum() {
    let (energy, start) = double_pendulum();
    for alphas in [Alphas::Last, Alphas::All] {
        let h = DoubleDouble::ratio(1, 5);
        let steps = quadratic_steps("double pendulum", &energy, &start, h, alphas);
        // Measured 25 and 23; one sequence: 1.2e-1 2.2e-3 3.1e-7 1.4e-14 1.9e-29.
        assert!(steps >= 12);
    }
}
