//! A further, non-quadratic invariant kept by the same α's: the Laplace–Runge–Lenz vector of Kepler's
//! problem.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, IntegrateError, Integrator, Invariant, Outcome, Record, Run};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::{Start, distance, kepler};
use std::f64::consts::TAU;

/// A_y = −p_x L − q_y/r with L = q × p: zero for an orbit whose pericentre lies on the x axis.
fn lenz() -> Invariant {
    let function = Hamiltonian::new(2, |q, p| {
        let l = q[0] * p[1] - q[1] * p[0];
        -(p[0] * l) - q[1] / q[0].hypot(q[1])
    });
    Invariant::new("Laplace-Runge-Lenz y", function.unwrap())
}

/// Periods of Kepler's problem, e = 0.6, and a quarter; the error is the distance to the closed form.
fn orbit(stages: usize, steps_per_period: u32, periods: f64, keep: bool) -> (Run<f64>, f64) {
    let end = (periods + 0.25) * TAU;
    let (h, start): (Hamiltonian, Start<f64>) = kepler(6);
    let method = Equip::stages(stages)
        .step(TAU / f64::from(steps_per_period))
        .record(Record::Ends);
    let method = if keep {
        method.preserve(lenz())
    } else {
        method.invariant(lenz())
    };
    let run = method.integrate(&h, &start.q, &start.p, 0.0..=end).unwrap();
    let orbit = equip_scenes::find("kepler")
        .unwrap()
        .instance(&[("e", "0.6")])
        .unwrap();
    let (q, p) = orbit.exact(DoubleDouble::exact(end)).unwrap();
    let exact: Vec<f64> = q.iter().chain(&p).map(|x| x.to_f64()).collect();
    let (_, q, p) = run.last();
    let error = distance(&[q, p].concat(), &exact);
    (run, error)
}

/// The table of docs/conserved.md.
#[test]
#[ignore = "long: .ci/figures runs it"]
fn a_further_invariant_over_a_thousand_periods() {
    let mut table = String::from(
        "| s, steps per period | Laplace–Runge–Lenz y, without → with | error of the end state, without → with | \
         steps uncorrected |\n|---|---|---|---|\n",
    );
    for (stages, steps) in [(3, 160), (4, 80), (4, 160), (6, 40)] {
        let [free, kept] = [false, true].map(|keep| orbit(stages, steps, 1000.0, keep));
        let defect = |run: &Run<f64>| run.certificate().invariants[0].max;
        let counts = &kept.0.certificate().counts;
        table += &format!(
            "| {stages}, {steps} | {:.1e} → {:.1e} | {:.1e} → {:.1e} | {} of {} |\n",
            defect(&free.0),
            defect(&kept.0),
            free.1,
            kept.1,
            counts.uncorrected(),
            counts.steps,
        );
    }
    println!("\n{table}");
}

#[test]
#[ignore = "known deficit: with three stages some steps do not keep the vector, 5.7e-11"]
fn the_lenz_vector_is_kept_with_the_energy_and_the_orbit_gains() {
    let (free, error_free) = orbit(3, 160, 50.0, false);
    let (kept, error_kept) = orbit(3, 160, 50.0, true);
    let (free, kept) = (free.certificate(), kept.certificate());
    // Over 1000 periods: docs/conserved.md.
    assert!(free.invariants[0].max > 1e-8, "{}", free.invariants[0].max);
    assert!(kept.invariants[0].max < 4e-15, "{}", kept.invariants[0].max);
    assert!(kept.energy.as_ref().unwrap().max < 4e-15);
    assert!(kept.energy_conserved_on_every_step(), "{kept}");
    assert!(
        error_kept < error_free / 5.0,
        "{error_kept} against {error_free}"
    );
}

#[test]
fn more_equations_than_alphas_are_refused() {
    let (h, start): (Hamiltonian, Start<f64>) = kepler(6);
    let run = Equip::stages(2)
        .step(0.1)
        .preserve(lenz())
        .start(&h, &start.q, &start.p, 0.0);
    let error = run.map(|_| ()).unwrap_err();
    assert_eq!(error, IntegrateError::TooFewAlphas { kept: 2, alphas: 1 });
    assert!(error.to_string().contains("at least 3 stages"), "{error}");
}

/// The energies of three of four springs, and with the whole energy that of the fourth: more equations than
/// α's that move otherwise.
#[test]
fn as_many_invariants_as_there_are_alphas() {
    let spring = |i: usize, k: f64| {
        let function = Hamiltonian::new(4, move |q, p| {
            0.5 * p[i] * p[i] + 0.5 * k * q[i] * q[i] + 0.25 * q[i].powi(4)
        });
        Invariant::new(format!("spring {i}"), function.unwrap())
    };
    let h = Hamiltonian::new(4, |q, p| {
        let springs = q.iter().zip(p).zip([1.0, 1.5, 0.7, 1.2]);
        let energies = springs.map(|((&q, &p), k)| 0.5 * (p * p + k * q * q) + 0.25 * q.powi(4));
        energies.sum()
    });
    let (q, p) = ([1.0, 0.4, -0.8, 0.6], [0.0, 1.1, 0.3, -0.5]);
    let method = |keeps: bool| {
        let method = Equip::stages(6).step(0.4).record(Record::Ends);
        [(0, 1.0), (1, 1.5), (2, 0.7)]
            .into_iter()
            .fold(method, |method, (i, k)| match keeps {
                true => method.preserve(spring(i, k)),
                false => method.invariant(spring(i, k)),
            })
    };
    let worst = |keeps: bool| {
        let run = method(keeps).integrate(h.as_ref().unwrap(), &q, &p, 0.0..=20.0);
        let run = run.unwrap();
        let invariants = run.certificate().invariants.iter().map(|kept| kept.max);
        (invariants.fold(0.0, f64::max), run)
    };
    let ((free, _), (kept, run)) = (worst(false), worst(true));
    // Where a slope nearly vanishes a step is uncorrected, and its defect removed by the next ones.
    let solved = run.certificate().counts.outcome(Outcome::Solved);
    println!("{free:e} {kept:e} {solved}");
    assert!(solved > 35, "{}", run.certificate());
    assert!(kept < free / 2.0, "{free:e} {kept:e}");
}

/// No α changes a quadratic invariant: to preserve one is to measure it.
#[test]
fn a_quadratic_invariant_needs_no_alpha() {
    let (h, start): (Hamiltonian, Start<f64>) = kepler(6);
    let moment = Hamiltonian::new(2, |q, p| q[0] * p[1] - q[1] * p[0]).unwrap();
    let moment = Invariant::new("angular momentum", moment);
    let method = Equip::stages(4).tolerance(1e-8);
    let run = |method: Integrator<f64>| {
        let run = method.integrate(&h, &start.q, &start.p, 0.0..=20.0 * TAU);
        run.unwrap()
    };
    let (plain, preserved) = (run(method.clone()), run(method.preserve(moment)));
    assert_eq!(plain.last(), preserved.last());
    let certificate = preserved.certificate();
    assert!(certificate.energy_conserved_on_every_step());
    assert!(certificate.invariants[0].max < 1e-13, "{certificate}");
}
