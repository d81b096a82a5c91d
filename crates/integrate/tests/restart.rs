//! A run that is begun anew with what another one has made ready is a new run, bit for bit, and costs no
//! allocation.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use crate::memory::allocations;
use equip_autodiff::Hamiltonian;
use equip_integrate::{
    Alphas, Equip, Gauss, IntegrateError, Integrator, Invariant, Method, Preconditioner, Record,
    StepView, Stepper,
};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::Instance;
use std::ops::ControlFlow;

fn scene(name: &str, values: &[(&str, &str)]) -> Instance {
    equip_scenes::find(name).unwrap().instance(values).unwrap()
}

/// The certificate without the time that the run took.
fn certified<T: Float>(run: &Stepper<T>) -> String {
    let mut certificate = run.certificate();
    certificate.seconds = 0.0;
    format!("{certificate:?}")
}

/// Everything a step shows, by its bits.
fn bits<T: Float>(view: &StepView<'_, T>) -> (u64, Vec<[u64; 6]>, String) {
    let numbers = [view.time, view.step].into_iter();
    let numbers = numbers.chain(view.q.iter().chain(view.p).chain(view.alphas).copied());
    let numbers = numbers
        .chain(view.energy_error)
        .chain(view.energy_round_off);
    let bits = numbers.map(|x| x.expansion().map(f64::to_bits)).collect();
    (view.index, bits, format!("{:?}", view.outcome))
}

/// Twice the state of a scene, turned a little: another start that is as good.
fn elsewhere<T: Float>(q: &[T], p: &[T]) -> (Vec<T>, Vec<T>) {
    let nearly = |x: &[T], k: i64| x.iter().map(|&x| x * T::ratio(k, 128)).collect();
    (nearly(q, 127), nearly(p, 129))
}

/// The first `steps` steps of a new run from the scene's start are those of one that was somewhere else
/// before.
fn same_again<T: Float>(scene: &Instance, options: &Integrator<T>, steps: usize) {
    let h = scene.hamiltonian();
    let (q, p) = scene.initial::<T>();
    let (other_q, other_p) = elsewhere(&q, &p);
    let t0 = T::int(3);
    let mut fresh = options.start(h, &q, &p, t0).unwrap();
    let mut prepared = options.prepare(h).unwrap();
    let again = prepared.start(&other_q, &other_p, T::int(0)).unwrap();
    for _ in 0..steps + 1 {
        again.advance().unwrap();
    }
    let before = allocations();
    again.restart(&q, &p, t0).unwrap();
    assert_eq!(allocations(), before, "a restart allocates");
    assert_eq!(certified(again), certified(&fresh));
    for _ in 0..steps {
        let (new, old) = (
            bits(&again.advance().unwrap()),
            bits(&fresh.advance().unwrap()),
        );
        assert_eq!(new, old, "{}", certified(&fresh));
    }
    assert_eq!(certified(again), certified(&fresh));
    // The same once more, as a run that was prepared.
    let before = allocations();
    let again = prepared.start(&q, &p, t0).unwrap();
    assert_eq!(allocations(), before, "a start allocates");
    let mut fresh = options.start(h, &q, &p, t0).unwrap();
    assert_eq!(
        bits(&again.advance().unwrap()),
        bits(&fresh.advance().unwrap())
    );
}

#[test]
fn fixed_steps() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    for method in [
        Gauss::stages(3),
        Equip::stages(2),
        Equip::stages(4),
        Equip::stages(4).alphas(Alphas::Last),
        Method::fixed_alpha(3, 0.01),
    ] {
        same_again(&kepler, &method.step(0.3), 40);
        same_again(&kepler, &method.step(DoubleDouble::ratio(3, 10)), 6);
    }
    for solver in [
        Preconditioner::Identity,
        Preconditioner::Diagonal,
        Preconditioner::Full,
        Preconditioner::Frozen,
    ] {
        // Steps so long that some are halved.
        let options = Equip::stages(4).step(0.7).preconditioner(solver);
        same_again(&kepler, &options, 30);
    }
    let henon = scene("henon-heiles", &[]);
    same_again(&henon, &Equip::stages(6).step(0.5), 40);
    let ring = scene("dnls", &[("n", "16")]);
    same_again(&ring, &Equip::stages(4).step(0.5), 20);
}

#[test]
fn variable_steps() {
    let kepler = scene("kepler", &[("e", "0.8")]);
    for s in [3, 8] {
        same_again(&kepler, &Equip::stages(s).tolerance(1e-10), 60);
        let options = Equip::stages(s).tolerance(1e-8).first_step(0.01);
        same_again(&kepler, &options, 30);
    }
}

#[test]
fn what_is_watched_and_kept_begins_anew() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    let energy = Hamiltonian::new(2, |q, p| (q[0] * p[1] - q[1] * p[0]).powi(3)).unwrap();
    let options = Equip::stages(5)
        .step(0.2)
        .invariant(Invariant::new("angular momentum", energy.clone()));
    same_again(&kepler, &options, 30);
    let options = Equip::stages(5)
        .step(0.2)
        .preserve(Invariant::new("its cube", energy));
    same_again(&kepler, &options, 30);
}

#[test]
fn a_run_goes_on_from_another_state_as_one_that_starts_there() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    let h = kepler.hamiltonian();
    let (q, p) = kepler.initial::<f64>();
    let (other_q, other_p) = elsewhere(&q, &p);
    // A power of two: times are exact.
    let options = Equip::stages(4).step(0.25);
    let mut run = options.start(h, &other_q, &other_p, 0.0).unwrap();
    for _ in 0..8 {
        run.advance().unwrap();
    }
    let before = allocations();
    run.set_state(&q, &p).unwrap();
    assert_eq!(allocations(), before);
    let mut fresh = options.start(h, &q, &p, run.time()).unwrap();
    for _ in 0..20 {
        let (kicked, view) = (run.advance().unwrap(), fresh.advance().unwrap());
        assert_eq!(kicked.index, view.index + 8);
        let (kicked, view) = (bits(&kicked).1, bits(&view).1);
        assert_eq!(kicked, view);
    }
    let energy = run.certificate().energy.unwrap();
    assert_eq!(energy.start, fresh.certificate().energy.unwrap().start);
    assert_eq!(run.certificate().counts.steps, 28);
}

#[test]
fn a_start_that_is_refused_leaves_the_run_as_it_was() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    let (q, p) = kepler.initial::<f64>();
    let options = Equip::stages(4).step(0.25);
    let start = || options.start(kepler.hamiltonian(), &q, &p, 0.0).unwrap();
    let (mut run, mut whole) = (start(), start());
    for _ in 0..5 {
        run.advance().unwrap();
        whole.advance().unwrap();
    }
    let refused = run.restart(&[0.0, 0.0], &p, 0.0).unwrap_err();
    assert!(matches!(refused, IntegrateError::EnergyNotFinite { .. }));
    let refused = run.restart(&q[..1], &p, 0.0).unwrap_err();
    assert!(matches!(refused, IntegrateError::WrongLength { .. }));
    let refused = run.restart(&q, &p, f64::INFINITY).unwrap_err();
    assert!(matches!(refused, IntegrateError::Interval { .. }));
    let refused = run.restart(&q, &p, 1e30).unwrap_err();
    assert!(matches!(
        refused,
        IntegrateError::StepBelowTimeResolution { .. }
    ));
    for _ in 0..5 {
        assert_eq!(
            bits(&run.advance().unwrap()),
            bits(&whole.advance().unwrap())
        );
    }
}

#[test]
fn whole_runs_of_one_preparation_are_those_of_many() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    let h = kepler.hamiltonian();
    let (q, p) = kepler.initial::<f64>();
    let (other_q, other_p) = elsewhere(&q, &p);
    let options = Equip::stages(4).tolerance(1e-9).record(Record::Every(2));
    let mut prepared = options.prepare(h).unwrap();
    for (q, p) in [(&q, &p), (&other_q, &other_p), (&q, &p)] {
        let again = prepared.integrate(q, p, 0.0..=20.0).unwrap();
        let fresh = options.integrate(h, q, p, 0.0..=20.0).unwrap();
        assert_eq!(again.times(), fresh.times());
        let states = |run: &equip_integrate::Run<f64>| {
            let state = |i: usize| [run.q(i), run.p(i)].concat();
            (0..run.len()).map(state).collect::<Vec<_>>()
        };
        assert_eq!(states(&again), states(&fresh));
    }
}

#[test]
fn an_observer_ends_a_prepared_run_and_the_next_is_whole() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    let h = kepler.hamiltonian();
    let (q, p) = kepler.initial::<f64>();
    let options = Equip::stages(4).step(0.125);
    let mut prepared = options.prepare(h).unwrap();
    let mut seen = 0;
    let mut watch = |_: &StepView<'_, f64>| {
        seen += 1;
        match seen {
            3 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    };
    let run = prepared.integrate_observed(&q, &p, 0.0..=20.0, &mut watch);
    let run = run.unwrap();
    assert!(run.stopped() && run.last().0 == 0.375);
    let whole = prepared.integrate(&q, &p, 0.0..=20.0).unwrap();
    let fresh = options.integrate(h, &q, &p, 0.0..=20.0).unwrap();
    assert_eq!(whole.last(), fresh.last());
}

/// Measured: a start beside a step of Kepler's problem; run with
/// `cargo test -p equip-integrate --release --test all restart:: -- --ignored --nocapture`.
#[test]
#[ignore = "timing"]
fn a_restart_costs_less_than_two_steps() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    let (q, p) = kepler.initial::<f64>();
    for s in [4, 8] {
        let options = Equip::stages(s).step(0.05);
        let mut run = options.start(kepler.hamiltonian(), &q, &p, 0.0).unwrap();
        // The best of many short rounds: what the machine does beside is left out.
        let time = |f: &mut dyn FnMut()| {
            let round = |_| {
                let begun = std::time::Instant::now();
                (0..20).for_each(|_| f());
                begun.elapsed().as_secs_f64() / 20.0 * 1e6
            };
            (0..500).map(round).fold(f64::INFINITY, f64::min)
        };
        let step = time(&mut || {
            run.advance().unwrap();
        });
        let restart = time(&mut || run.restart(&q, &p, 0.0).unwrap());
        let start = time(&mut || {
            options.start(kepler.hamiltonian(), &q, &p, 0.0).unwrap();
        });
        println!("s = {s}: step {step:.3} µs, restart {restart:.3} µs, start {start:.3} µs");
        assert!(restart < 2.0 * step);
    }
}
