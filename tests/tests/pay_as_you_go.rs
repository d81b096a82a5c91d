//! A scene pays only for what it needs: quadratic H, states at rest, defects below the round-off level.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Alphas, Counts, Equip, Gauss, Method, Outcome};
use equip_scalar::{Constant, DoubleDouble, Float, ratio};
use equip_tests::{Start, decimal_digits, distance, harmonic, kepler, pendulum};

const BOTH: [Alphas; 2] = [Alphas::Several, Alphas::Last];

/// States of all steps of a run, and its counts.
fn states<T: Float>(
    method: Method,
    h: T,
    steps: usize,
    energy: &Hamiltonian,
    start: &Start<T>,
) -> (Vec<T>, Counts) {
    let mut run = method
        .step(h)
        .start(energy, &start.q, &start.p, T::int(0))
        .unwrap();
    let mut all = Vec::new();
    for _ in 0..steps {
        let view = run.advance().unwrap();
        all.extend(view.q.iter().chain(view.p));
    }
    (all, *run.counts())
}

/// The counts of work, without those of outcomes.
fn work(c: &Counts) -> [u64; 8] {
    [
        c.newton_iterations,
        c.factorisations,
        c.gradients,
        c.energies,
        c.hessians,
        c.directions,
        c.alpha_updates,
        c.halvings,
    ]
}

fn quadratic_costs_what_gauss_costs<T: Float>(digits: f64) {
    let frequencies: [Constant; 3] = [ratio(1, 3), 1.0.into(), 7.0.into()];
    let (energy, start) = harmonic::<T>(&frequencies);
    let (h, steps) = (T::ratio(1, 10), 300);
    for s in [2, 3, 5] {
        let (gauss, gauss_counts) = states(Gauss::stages(s), h, steps, &energy, &start);
        for alphas in BOTH {
            let method = Equip::stages(s).alphas(alphas);
            let (equip, counts) = states(method, h, steps, &energy, &start);
            assert_eq!(counts.outcome(Outcome::Quadratic), steps as u64);
            assert_eq!(counts.alpha_updates, 0);
            assert_eq!(work(&counts), work(&gauss_counts));
            assert_eq!(equip, gauss);
            let certificate = {
                let mut run = method
                    .step(h)
                    .start(&energy, &start.q, &start.p, T::int(0))
                    .unwrap();
                for _ in 0..steps {
                    run.advance().unwrap();
                }
                run.certificate()
            };
            let defect = certificate.energy.unwrap();
            println!(
                "{method}, {}: |H - H0| {:.1e} of {:.1}",
                T::NAME,
                defect.max,
                defect.start
            );
            assert!(decimal_digits(defect.max / defect.start) > digits);
            assert!(certificate.alpha_range.is_empty());
        }
    }
}

#[test]
fn a_quadratic_energy_solves_no_alpha_and_costs_what_gauss_costs() {
    // Measured: see the printed defects; headroom of one digit.
    quadratic_costs_what_gauss_costs::<f64>(13.0);
    quadratic_costs_what_gauss_costs::<DoubleDouble>(29.0);
}

fn stays_at_rest<T: Float>() {
    let (energy, _) = pendulum::<T>();
    let zero = T::int(0);
    // The stable equilibrium, to the last bit.
    let rest = Start {
        q: vec![zero],
        p: vec![zero],
    };
    for alphas in BOTH {
        let method = Equip::stages(3).alphas(alphas);
        let (all, counts) = states(method, T::ratio(1, 10), 100, &energy, &rest);
        assert!(all.iter().all(|x| *x == zero));
        assert_eq!(counts.outcome(Outcome::AtRoundOff), 100);
        assert_eq!(counts.directions, 0);
    }
    // The unstable one, as near as the float type gets: sin(π rounded) grows like eᵗ from there.
    let top = Start {
        q: vec![T::pi()],
        p: vec![zero],
    };
    let (all, counts) = states(Equip::stages(3), T::ratio(1, 10), 100, &energy, &top);
    let away = all
        .chunks_exact(2)
        .map(|y| (y[0] - T::pi()).abs())
        .fold(zero, |a, x| a.max(x));
    println!(
        "{}: after 10 time units {away:.1e} off the upper equilibrium",
        T::NAME
    );
    // e^10/2 = 11013 times |sin π rounded| ≤ ε, plus as much for the rounding of q.
    assert!(away <= T::int(100_000) * T::EPSILON);
    assert_eq!(counts.outcome(Outcome::AtRoundOff), 100);
}

#[test]
fn a_start_at_an_equilibrium_stays() {
    stays_at_rest::<f64>();
    stays_at_rest::<DoubleDouble>();
}

fn turning_point<T: Float>(digits: f64) {
    // Released at rest from q = 1: ∇H has no component along the velocity, which is zero.
    let (energy, _) = pendulum::<T>();
    let start = Start {
        q: vec![T::int(1)],
        p: vec![T::int(0)],
    };
    for alphas in BOTH {
        let method = Equip::stages(4).alphas(alphas);
        let h = T::ratio(1, 10);
        let mut run = method
            .step(h)
            .start(&energy, &start.q, &start.p, T::int(0))
            .unwrap();
        for _ in 0..200 {
            let view = run.advance().unwrap();
            assert!(view.outcome.energy_conserved(), "{:?}", view.outcome);
        }
        let end = [run.view().q, run.view().p].concat();
        assert!(decimal_digits(run.certificate().energy.unwrap().max) > digits);
        let last = |all: Vec<T>| all[all.len() - 2..].to_vec();
        let exact = last(states(Gauss::stages(8), T::ratio(1, 20), 400, &energy, &start).0);
        let gauss = last(states(Gauss::stages(4), h, 200, &energy, &start).0);
        let (error, gauss_error) = (distance(&end, &exact), distance(&gauss, &exact));
        println!(
            "{method}, {}: error at t = 20 {error:.2e}, Gauss {gauss_error:.2e}",
            T::NAME
        );
        // Never judge by the energy. Measured 1.2e-13 and 1.6e-13 against 2.3e-14: on this orbit the energy
        // costs a factor in the phase, of no more than 7.
        assert!(error <= T::int(10) * gauss_error);
    }
}

#[test]
#[ignore = "known deficit: the first step is uncorrected: the end point moved too far"]
fn a_start_at_a_turning_point() {
    // Steps of up to 4 floors stay Gauss steps.
    turning_point::<f64>(14.5);
    turning_point::<DoubleDouble>(29.5);
}

fn below_the_floor<T: Float>(h: T, s: usize) {
    let (energy, start) = kepler::<T>(6);
    let (gauss, gauss_counts) = states(Gauss::stages(s), h, 200, &energy, &start);
    for alphas in BOTH {
        let method = Equip::stages(s).alphas(alphas);
        let (equip, counts) = states(method, h, 200, &energy, &start);
        assert_eq!(
            counts.outcome(Outcome::AtRoundOff),
            200,
            "{method}: {counts:?}"
        );
        assert_eq!(counts.directions, 0, "{method}: {counts:?}");
        assert_eq!(counts.newton_iterations, gauss_counts.newton_iterations);
        assert_eq!(counts.factorisations, gauss_counts.factorisations);
        // The same but for rounding: EQUIP knows the gradient where a step starts, and its iterations start
        // nearer.
        let off = equip.iter().zip(&gauss).map(|(&a, &b)| (a - b).abs());
        let off = off.fold(T::int(0), |most, x| most.max(x));
        println!("{method}, {}: {:e}", T::NAME, off.to_f64());
        assert!(off <= T::int(64) * T::EPSILON);
        let mut run = method
            .step(h)
            .start(&energy, &start.q, &start.p, T::int(0))
            .unwrap();
        for _ in 0..200 {
            assert!(
                run.advance()
                    .unwrap()
                    .alphas
                    .iter()
                    .all(|a| *a == T::int(0))
            );
        }
    }
}

#[test]
fn a_step_so_small_that_the_defect_is_rounding_is_a_gauss_step() {
    below_the_floor::<f64>(1e-4, 3);
    below_the_floor::<f64>(1e-3, 4);
    below_the_floor::<DoubleDouble>(DoubleDouble::ratio(1, 10_000), 5);
}

#[test]
fn an_energy_not_measured_is_not_evaluated() {
    let (energy, start) = kepler::<f64>(6);
    let options = Gauss::stages(3).step(0.05).measure_energy(false);
    let run = options
        .integrate(&energy, &start.q, &start.p, 0.0..=1.0)
        .unwrap();
    assert_eq!(run.certificate().counts.energies, 0);
    assert!(run.certificate().energy.is_none() && run.energy_errors().is_empty());
}
