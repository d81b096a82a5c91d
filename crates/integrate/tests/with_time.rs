//! H(t, q, p) by `Hamiltonian::with_time`: runs start, are watched and are read like all others.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::{
    Chaos, Checkpoint, Equip, Event, Gauss, IntegrateError, Integrator, Invariant, NoObserver,
    Observer, StepView, TangentMap, Target,
};
use equip_scalar::{DoubleDouble, Float, ratio};
use std::ops::ControlFlow;

fn driven(t: Var, q: &[Var], p: &[Var]) -> Var {
    0.5 * (p[0] * p[0] + q[0] * q[0]) - q[0] * (ratio(1, 2) * t).cos()
}

/// q'' = −q + cos(t/2), separable.
fn pushed() -> Hamiltonian {
    Hamiltonian::with_time(1, driven).unwrap()
}

/// From rest at 0: q = 4/3 (cos(t/2) − cos t).
fn exact<T: Float>(t: T) -> [T; 2] {
    let half = t / T::int(2);
    let q = half.cos() - t.cos();
    let p = t.sin() - half.sin() / T::int(2);
    [q, p].map(|x| T::ratio(4, 3) * x)
}

/// q'' + q'/5 + q = 0 (Caldirola and Kanai), not separable: p = e^{t/5} q'.
fn damped() -> Hamiltonian {
    Hamiltonian::with_time(1, |t, q, p| {
        let grown = (0.2 * t).exp();
        0.5 * (p[0] * p[0] / grown + grown * q[0] * q[0])
    })
    .unwrap()
}

/// A particle in a magnetic field that oscillates: H(t, q, −p) ≠ H(t, q, p); `sign` is that of H and of t.
fn field(sign: f64) -> Hamiltonian {
    Hamiltonian::with_time(2, |t, q, p| {
        let strength = (sign * 0.7) * ((sign * 1.3) * t).cos();
        (sign * 0.5) * (p[0] * p[0] + p[1] * p[1])
            + strength * (q[0] * p[1] - q[1] * p[0])
            + (sign * 0.25) * (q[0] * q[0] + q[1] * q[1])
    })
    .unwrap()
}

#[test]
fn closed_forms_in_both_precisions() {
    let options = Equip::stages(6).tolerance(1e-13);
    let run = options
        .integrate(&pushed(), &[0.0], &[0.0], 0.0..=50.0)
        .unwrap();
    let (t, q, p) = run.last();
    assert_eq!((t, q.len(), p.len(), run.q(3).len()), (50.0, 1, 1, 1));
    let [x, y] = exact(50.0);
    let error = (q[0] - x).abs().max((p[0] - y).abs());
    let certificate = run.certificate();
    println!("{error:.1e}, {} steps", run.len() - 1);
    // Measured 1e-13.
    assert!(error < 2e-12 && certificate.energy_conserved_on_every_step());
    assert!(certificate.energy.as_ref().unwrap().max < 2e-14);
    assert_eq!(certificate.energy.as_ref().unwrap().start, 0.0);

    for t1 in [10.0, -10.0] {
        let run = options
            .integrate(&damped(), &[1.0], &[0.0], 0.0..=t1)
            .unwrap();
        let omega = 0.99f64.sqrt();
        let q = (-0.1 * t1).exp() * ((omega * t1).cos() + 0.1 / omega * (omega * t1).sin());
        let error = (run.last().1[0] - q).abs();
        println!("damped to {t1}: {error:.1e}");
        assert!(error < 1e-12);
    }

    let int = DoubleDouble::int;
    let options = Equip::stages(10).tolerance(DoubleDouble::decimal("1e-25").unwrap());
    let run = options.integrate(&pushed(), &[int(0)], &[int(0)], int(0)..=int(10));
    let [x, _] = exact(int(10));
    let error = (run.unwrap().last().1[0] - x).abs().to_f64();
    // Measured 5e-29: the oscillation is resolved beyond the tolerance.
    assert!(error < 1e-25, "{error:.1e}");
}

#[test]
fn the_size_of_the_time_does_not_matter() {
    // The solution without an oscillation of its own: q = 4/3 cos(t/2).
    let made = |t0: f64| {
        let at = |t: f64| [4.0 / 3.0 * (0.5 * t).cos(), -2.0 / 3.0 * (0.5 * t).sin()];
        let ([q, p], t1) = (at(t0), t0 + 40.0);
        let options = Equip::stages(6).tolerance(1e-9);
        let run = options.integrate(&pushed(), &[q], &[p], t0..=t1).unwrap();
        ((run.last().1[0] - at(t1)[0]).abs(), run.len())
    };
    let ((near, steps), (far, as_many)) = (made(0.0), made(160_000.0 * std::f64::consts::TAU));
    println!("{near:.1e} in {steps} steps, from 1e6 {far:.1e} in {as_many}");
    assert!(near < 1e-8 && far < 1e-8 && 4 * as_many <= 5 * steps);
}

#[test]
fn what_watches_a_run_has_states_of_its_degrees_of_freedom() {
    let h = pushed();
    let mut lengths = Vec::new();
    let mut energy = h.function::<f64>();
    let mut last = 0.0;
    let mut observe = |view: &StepView<'_, f64>| {
        lengths.push((view.q.len(), view.p.len()));
        last = energy.value(view.time, view.q, view.p);
        ControlFlow::Continue(())
    };
    let line = Hamiltonian::with_time(1, |t, q, _| q[0] - ratio(1, 10) * t).unwrap();
    let position = Hamiltonian::new(1, |q, _| q[0]).unwrap();
    let options = Equip::stages(6)
        .tolerance(1e-12)
        .dense()
        .chaos()
        .output_at(&[1.0, 7.5])
        .event(Event::new("turning point", |_, _, p: &[f64]| p[0]))
        .event(Event::recorded("a line", line))
        .invariant(Invariant::new("H", h.clone()))
        .invariant(Invariant::new("q", position));
    let run = options
        .integrate_observed(&h, &[0.0], &[0.0], 0.0..=10.0, &mut observe)
        .unwrap();
    assert!(lengths.iter().all(|&lengths| lengths == (1, 1)));
    // H itself is not kept: what the certificate watches is what an observer sees.
    let [energy, position] = [0, 1].map(|i| run.certificate().invariants[i].clone());
    assert_eq!((energy.start, position.start), (0.0, 0.0));
    assert!((energy.end - last).abs() < 1e-15 && energy.max > 0.5);
    assert_eq!(position.end, run.last().1[0]);
    let outputs: Vec<_> = run
        .outputs()
        .map(|(t, q, p)| (t, [q, p].concat()))
        .collect();
    assert_eq!(outputs.len(), 2);
    let trajectory = run.trajectory().unwrap();
    for (t, y) in &outputs {
        let (q, p) = trajectory.at(*t).unwrap();
        for state in [y, &[q, p].concat()] {
            for (x, exact) in state.iter().zip(exact(*t)) {
                assert!((x - exact).abs() < 1e-11);
            }
        }
    }
    // p = 4/3 sin(t/2) (2 cos(t/2) − 1/2).
    let turning = run.events().iter().filter(|event| event.event == 0);
    assert_eq!(turning.count(), 3);
    assert!(run.events().iter().any(|event| event.event == 1));
    for event in run.events() {
        let [q, p] = exact(event.time);
        let zero = match event.event {
            0 => p,
            _ => q - 0.1 * event.time,
        };
        assert!(zero.abs() < 1e-11 && event.q.len() == 1);
    }
}

#[test]
fn recorded_events_are_functions_of_time_in_every_run() {
    // A wall that moves, met by a free particle: 1 + t/10 = t at 10/9, to thirty digits.
    let free = Hamiltonian::new(1, |_, p| 0.5 * p[0] * p[0]).unwrap();
    let wall = Hamiltonian::with_time(1, |t, q, _| q[0] - 1.0 - ratio(1, 10) * t).unwrap();
    let int = DoubleDouble::int;
    let run = Equip::stages(4)
        .step(DoubleDouble::ratio(1, 3))
        .event(Event::recorded("wall", wall.clone()).terminal())
        .invariant(Invariant::new("distance", wall))
        .integrate(&free, &[int(0)], &[int(1)], int(0)..=int(5))
        .unwrap();
    let (t, off) = (run.last().0, DoubleDouble::ratio(10, 9));
    assert!(run.stopped() && (t - off).abs().to_f64() < 1e-30);
    assert!(
        (run.certificate().invariants[0].start + int(1))
            .abs()
            .to_f64()
            < 1e-30
    );
}

/// Keeps the checkpoint after a step.
struct Keep(u64, u64, Option<Checkpoint>);

impl<T: Float> Observer<T> for Keep {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        self.0 = view.index;
        ControlFlow::Continue(())
    }

    fn wants_checkpoint(&mut self) -> bool {
        self.0 == self.1
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        self.2 = Some(checkpoint);
        ControlFlow::Continue(())
    }
}

/// Stops and goes on, there and back, and −H(−t) forward in place of H back.
fn goes_both_ways(options: &Integrator<f64>, bound: f64) {
    let (h, q, p) = (field(1.0), [0.8, -0.3], [0.2, 0.6]);
    for end in [9.0, -9.0] {
        let mut keep = Keep(0, 5, None);
        let whole = options.integrate_observed(&h, &q, &p, 0.0..=end, &mut keep);
        let (whole, checkpoint) = (whole.unwrap(), keep.2.unwrap());
        checkpoint.check_start(&q, &p, 0.0).unwrap();
        let rest = options.integrate_from(&h, &checkpoint, end, &mut NoObserver);
        let rest = rest.unwrap();
        assert_eq!(whole.last(), rest.last());
        assert_eq!(whole.certificate().counts, rest.certificate().counts);
        let other = options.integrate_from(&field(-1.0), &checkpoint, end, &mut NoObserver);
        assert!(matches!(
            other.unwrap_err().error,
            IntegrateError::CheckpointOtherEnergy { .. }
        ));
        let mirror = options.integrate(&field(-1.0), &q, &p, 0.0..=-end).unwrap();
        assert_eq!(whole.last().1, mirror.last().1);
        assert_eq!(whole.last().2, mirror.last().2);

        let (t, q1, p1) = whole.last();
        let back = options.integrate(&h, q1, p1, t..=0.0).unwrap();
        let pairs = back
            .last()
            .1
            .iter()
            .chain(back.last().2)
            .zip(q.iter().chain(&p));
        let off = pairs.fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        println!("{off:.1e} in {} steps", back.len() + whole.len() - 2);
        assert!(off < bound * (back.len() + whole.len()) as f64);
    }
}

#[test]
fn they_go_back_and_go_on_bit_for_bit() {
    goes_both_ways(&Equip::stages(4).step(0.05), 1e-16);
    goes_both_ways(&Gauss::stages(6).step(0.125), 1e-16);
}

#[test]
fn they_go_back_by_a_tolerance_bit_for_bit() {
    goes_both_ways(&Equip::stages(8).tolerance(1e-13), 1e-13);
}

/// Step control itself is a mirror, and so are α's whose directions are those of ∇²H to rounding.
#[test]
fn step_control_goes_back_bit_for_bit() {
    goes_both_ways(&Gauss::stages(8).tolerance(1e-13), 1e-13);
    let [q, p] = [[0.8, -0.3], [0.2, 0.6]].map(|x| x.map(DoubleDouble::exact));
    let options = Equip::stages(8).tolerance(DoubleDouble::exact(1e-18));
    let run = |sign: f64| {
        let span = DoubleDouble::int(0)..=DoubleDouble::exact(-9.0 * sign);
        options.integrate(&field(sign), &q, &p, span).unwrap()
    };
    let (back, mirror) = (run(1.0), run(-1.0));
    assert_eq!(back.len(), mirror.len());
    assert_eq!(back.last().1, mirror.last().1);
    assert_eq!(back.last().2, mirror.last().2);
    assert!(back.certificate().counts.alpha_updates > 5);
}

/// Pushed with a part of its frequency, an oscillator that does not swing itself has a motion that is slower
/// than what an error excites: with s stages its steps would be too long by as much.
#[test]
fn slow_pushes_of_a_fast_oscillator() {
    for (number, parts) in [(1, 2), (1, 5), (1, 20), (3, 4)] {
        let nu = f64::from(number) / f64::from(parts);
        let h = Hamiltonian::with_time(1, |t, q, p| {
            let push = (ratio(number.into(), parts.into()) * t).cos();
            0.5 * (p[0] * p[0] + q[0] * q[0]) - q[0] * push
        });
        let (h, size) = (h.unwrap(), 1.0 / (1.0 - nu * nu));
        let end = 40.0;
        for s in [4, 6, 8, 12] {
            for tolerance in [1e-5, 1e-7, 1e-9, 1e-11] {
                let options = Equip::stages(s).tolerance(tolerance);
                let run = options.integrate(&h, &[size], &[0.0], 0.0..=end).unwrap();
                let error = (run.last().1[0] - size * (nu * end).cos()).abs() / tolerance;
                println!(
                    "{nu} {s} {tolerance:e}: {error:.1e} in {} steps",
                    run.len() - 1
                );
                assert!(error < 30.0, "{nu} {s} {tolerance:e}: {error:.1e}");
            }
        }
    }
}

#[test]
fn steppers_start_are_moved_and_start_again() {
    let h = pushed();
    let mut prepared = Equip::stages(6).step(0.1).prepare(&h).unwrap();
    let run = prepared.start(&[0.0], &[0.0], 0.0).unwrap();
    let there = run.advance_to(3.0).unwrap().q[0];
    assert!((there - exact(3.0)[0]).abs() < 1e-12);
    // A kick, then the state it came from once more: the motion goes on, at its own time.
    let (q, p) = (run.view().q.to_vec(), run.view().p.to_vec());
    run.set_state(&[5.0], &[0.0]).unwrap();
    run.set_state(&q, &p).unwrap();
    let there = run.advance_to(6.0).unwrap().q[0];
    assert!((there - exact(6.0)[0]).abs() < 1e-12);
    let [q, p] = exact(2.0);
    run.restart(&[q], &[p], 2.0).unwrap();
    let there = run.advance_to(6.0).unwrap().q[0];
    assert!((there - exact(6.0)[0]).abs() < 1e-12);
    // A tangent vector of (q, p), and ones of (q, t, p, p_t): the start may be at another time.
    let mut run = Equip::stages(6)
        .step(0.1)
        .start(&h, &[0.0], &[0.0], 0.0)
        .unwrap();
    let mut chaos = Chaos::new(&h, &mut run, &[1.0, 0.5]);
    chaos.advance_to(&mut run, 40.0).unwrap();
    assert!(chaos.lyapunov().abs() < 0.1);
    run.restart(&[0.0], &[0.0], 0.0).unwrap();
    let mut tangent = TangentMap::new(&h, &mut run);
    let mut columns = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
    tangent.advance_to(&mut run, 3.0, &mut columns).unwrap();
    assert!((columns[0] - 3f64.cos()).abs() < 1e-11 && (columns[2] + 3f64.sin()).abs() < 1e-11);
    // ∂q/∂t0 at fixed τ = t − t0: q'' = −q + cos((t0 + τ)/2) gives −1/2 sin(τ/2) as its source.
    let by_start = -2.0 / 3.0 * (1.5f64.sin() - 0.5 * 3f64.sin());
    assert!(
        (columns[4] - by_start).abs() < 1e-11,
        "{} {by_start}",
        columns[4]
    );
    let method = Equip::stages(4);
    let step = method.suggest_step(&h, &[0.0], &[0.0], 0.0..=10.0, Target::Trajectory(1e-8));
    assert!(step.unwrap() > 0.1);
}

#[test]
fn functions_that_do_not_fit_are_refused() {
    let h = field(1.0);
    let start = ([0.8, -0.3], [0.2, 0.6]);
    let moment = |q: &[Var], p: &[Var]| (q[0] * p[1] - q[1] * p[0]).powi(3);
    let plain = Invariant::new("L³", Hamiltonian::new(2, moment).unwrap());
    let with_time = Hamiltonian::with_time(2, |_, q, p| moment(q, p)).unwrap();
    let options = Equip::stages(5).step(0.05);
    // Watched it may be either, kept it has to be one of time.
    let kept = options
        .clone()
        .preserve(Invariant::new("L³", with_time.clone()))
        .invariant(plain.clone())
        .integrate(&h, &start.0, &start.1, 0.0..=5.0)
        .unwrap();
    assert!(
        kept.certificate()
            .invariants
            .iter()
            .all(|defect| defect.max < 1e-14)
    );
    let error = options
        .clone()
        .preserve(plain)
        .start(&h, &start.0, &start.1, 0.0)
        .unwrap_err();
    assert!(error.to_string().contains("with_time"), "{error}");
    let one = Event::recorded("one", pushed());
    let error = options
        .event(one)
        .start(&h, &start.0, &start.1, 0.0)
        .unwrap_err();
    assert!(matches!(
        error,
        IntegrateError::WrongLength {
            expected: 2,
            found: 1,
            ..
        }
    ));
    let error = Equip::stages(4)
        .step(0.1)
        .start(&h, &[0.8, -0.3, 0.0], &start.1, 0.0);
    assert!(matches!(
        error.unwrap_err(),
        IntegrateError::WrongLength { expected: 2, .. }
    ));
}
