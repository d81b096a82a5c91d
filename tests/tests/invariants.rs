//! Energy and quadratic invariants at every step, and what keeping them does to the trajectory.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_integrate::{Alphas, Equip, Gauss, Method, Outcome, StepView};
use equip_scalar::{DoubleDouble, Float, ratio};
use equip_tests::{Start, Trend, distance, henon_heiles, kepler, trend};

/// What 160 steps per period of Kepler e = 0.6 over some periods show.
#[derive(Debug)]
struct Orbit {
    /// Largest |H − H(y0)|, from H evaluated here, not by the solver.
    energy: f64,
    /// q × p − q0 × p0, once per period.
    momentum: Vec<f64>,
    /// Largest |q × p − q0 × p0| at any step.
    momentum_max: f64,
    /// Distance to the start after the last period, max norm over (q, p).
    error: f64,
    /// Outcomes that kept the energy, and those that did not.
    solved: u64,
    steps: u64,
}

fn orbit<T: Float>(method: Method, periods: i64) -> Orbit {
    let (h, start) = kepler::<T>(6);
    let step = T::two_pi() / T::int(160);
    let mut run = method
        .step(step)
        .start(&h, &start.q, &start.p, T::int(0))
        .unwrap();
    let kinetic = |p: &[T]| (p[0] * p[0] + p[1] * p[1]) / T::int(2);
    let energy = |q: &[T], p: &[T]| kinetic(p) - T::int(1) / (q[0] * q[0] + q[1] * q[1]).sqrt();
    let moment = |q: &[T], p: &[T]| q[0] * p[1] - q[1] * p[0];
    let (e0, l0) = (energy(&start.q, &start.p), moment(&start.q, &start.p));
    let mut seen = Orbit {
        energy: 0.0,
        momentum: vec![0.0],
        momentum_max: 0.0,
        error: 0.0,
        solved: 0,
        steps: 0,
    };
    for _ in 0..periods {
        let mut defect = T::int(0);
        for _ in 0..160 {
            let view: StepView<'_, T> = run.advance().unwrap();
            seen.energy = seen
                .energy
                .max((energy(view.q, view.p) - e0).abs().to_f64());
            defect = moment(view.q, view.p) - l0;
            seen.momentum_max = seen.momentum_max.max(defect.abs().to_f64());
            seen.solved += u64::from(matches!(
                view.outcome,
                Outcome::Solved | Outcome::AtRoundOff
            ));
            seen.steps += 1;
        }
        seen.momentum.push(defect.to_f64());
    }
    let view = run.view();
    seen.error = distance(&[view.q, view.p].concat(), &start.state()).to_f64();
    let Trend {
        slope, random_walk, ..
    } = trend(&seen.momentum);
    println!(
        "{method}, {}, {periods} periods: energy {:.2e}, momentum max {:.2e} end {:.2e}, slope {slope:.1e} (random walk {random_walk:.1e}), error {:.3e}, kept {}/{}",
        T::NAME,
        seen.energy,
        seen.momentum_max,
        defect_end(&seen),
        seen.error,
        seen.solved,
        seen.steps
    );
    seen
}

fn defect_end(orbit: &Orbit) -> f64 {
    orbit.momentum.last().unwrap().abs()
}

/// The slope of the angular momentum is no more than rounding makes: 4 standard deviations.
fn no_trend(orbit: &Orbit) {
    let Trend {
        slope, random_walk, ..
    } = trend(&orbit.momentum);
    assert!(
        slope.abs() <= 4.0 * random_walk,
        "slope {slope:e}, random walk {random_walk:e}"
    );
}

fn keeps_energy_and_momentum_for_1000_periods(alphas: Alphas) {
    let gauss = orbit::<f64>(Gauss::stages(3), 1000);
    let equip = orbit::<f64>(Equip::stages(3).alphas(alphas), 1000);
    assert_eq!(equip.solved, 160_000);
    assert!(equip.energy <= 4e-15);
    assert!(defect_end(&equip) <= 1e-14);
    no_trend(&equip);
    no_trend(&gauss);
    assert!(10.0 * equip.error <= gauss.error);
}

#[test]
#[ignore = "known deficit: the single alpha keeps the energy on 43000 of 160000 steps"]
fn kepler_1000_periods_with_the_single_alpha_of_the_paper() {
    keeps_energy_and_momentum_for_1000_periods(Alphas::Last);
}

#[test]
fn kepler_1000_periods_with_all_alphas() {
    keeps_energy_and_momentum_for_1000_periods(Alphas::Several);
}

#[test]
#[ignore = "known deficit: the single alpha keeps the energy on 430 of 1600 steps"]
fn kepler_in_double_double_keeps_both_to_its_own_rounding() {
    for alphas in [Alphas::Last, Alphas::Several] {
        let equip = orbit::<DoubleDouble>(Equip::stages(3).alphas(alphas), 10);
        assert_eq!(equip.solved, 1600);
        assert!(equip.energy <= 1e-30);
        assert!(equip.momentum_max <= 1e-30);
        no_trend(&equip);
    }
}

#[test]
fn a_fixed_alpha_keeps_quadratic_invariants_and_not_the_energy() {
    for alpha in [ratio(1, 50), ratio(-1, 10)] {
        let fixed = orbit::<f64>(Method::fixed_alpha(3, alpha), 100);
        assert!(fixed.momentum_max <= 1e-14);
        no_trend(&fixed);
        assert!(fixed.energy > 1e-9, "nothing asks it to keep the energy");
        let fixed = orbit::<DoubleDouble>(Method::fixed_alpha(3, alpha), 3);
        assert!(fixed.momentum_max <= 1e-30);
    }
}

/// A symmetric method gives Kepler an error that grows linearly; keeping the energy makes its constant
/// smaller.
#[test]
fn the_error_grows_linearly_and_less_than_without_the_energy() {
    let growth = |method: Method| {
        let few = orbit::<DoubleDouble>(method, 3);
        let many = orbit::<DoubleDouble>(method, 24);
        ((many.error / few.error).log(8.0), many.error)
    };
    let (gauss, gauss_error) = growth(Gauss::stages(4));
    let (equip, equip_error) = growth(Equip::stages(4));
    // Measured 1.00 and 1.00; 2.35e-9 and 5.01e-10.
    assert!((gauss - 1.0).abs() < 0.05 && (equip - 1.0).abs() < 0.05);
    assert!(4.0 * equip_error <= gauss_error);
}

/// Chaotic Hénon–Heiles at a step so large that ∂g/∂α changes sign every few steps, without halving.
fn chaotic<T: Float>(alphas: Alphas, q2: &str, steps: u64) -> (u64, f64) {
    let (h, Start { q, p }) = henon_heiles::<T>(T::ratio(1, 6) - T::ratio(1, 1000), q2, "0.1");
    let options = Equip::stages(3)
        .alphas(alphas)
        .step(T::ratio(1, 2))
        .max_halvings(0);
    let mut run = options.start(&h, &q, &p, T::int(0)).unwrap();
    let mut worst = 0.0_f64;
    for _ in 0..steps {
        let view = run.advance().unwrap();
        worst = worst.max(view.energy_error.unwrap().abs().to_f64());
    }
    let counts = run.counts();
    let uncorrected = counts.uncorrected();
    let solved = counts.outcome(Outcome::Solved) + counts.outcome(Outcome::AtRoundOff);
    assert_eq!(solved + uncorrected, steps);
    println!(
        "{alphas:?}, {}: {uncorrected} of {steps} uncorrected, energy {worst:.1e}",
        T::NAME
    );
    (uncorrected, worst)
}

#[test]
#[ignore = "known deficit: 5 of 1000 steps are uncorrected with all alphas (q2 = -0.2)"]
fn all_alphas_solve_where_the_single_one_has_no_solution() {
    let mut without = 0;
    for q2 in ["-0.2", "0.1", "0.3", "0.5"] {
        let (uncorrected, worst) = chaotic::<f64>(Alphas::Several, q2, 1000);
        assert!(uncorrected == 0 && worst <= 1e-15);
        // The next step removes the energy error: the defect is that of single Gauss steps, it does not
        // grow.
        let (uncorrected, worst) = chaotic::<f64>(Alphas::Last, q2, 1000);
        assert!(worst <= 1e-5);
        without += uncorrected;
    }
    assert!(without > 0);
    let (uncorrected, worst) = chaotic::<DoubleDouble>(Alphas::Several, "-0.2", 300);
    assert!(uncorrected == 0 && worst <= 1e-31);
}
