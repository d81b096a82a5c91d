//! Events that change the state or end the run: the energy there, walls that are only touched, and runs that
//! begin on a root.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Event, Gauss, Integrator, Run, StepEvents};
use equip_scalar::{DoubleDouble, Float};
use std::ops::ControlFlow;

/// A particle in the plane, in a potential of degree four.
fn quartic() -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        let squares = q[0] * q[0] + q[1] * q[1];
        0.5 * (p[0] * p[0] + p[1] * p[1]) + 0.25 * squares * squares + 0.125 * q[0].powi(3)
    })
    .unwrap()
}

fn energy<T: Float>(q: &[T], p: &[T]) -> T {
    let squares = q[0] * q[0] + q[1] * q[1];
    let kinetic = (p[0] * p[0] + p[1] * p[1]) / T::int(2);
    kinetic + squares * squares / T::int(4) + q[0] * q[0] * q[0] / T::int(8)
}

/// Reflects the particle at q_0 = `at`.
fn wall<T: Float>(at: T) -> Event<T> {
    Event::new("wall", move |_, q: &[T], _: &[T]| q[0] - at).then(|_, _, p| {
        p[0] = -p[0];
        ControlFlow::Continue(())
    })
}

/// Reflects the particle at |q|² = 4/5.
fn circle<T: Float>() -> Event<T> {
    let g = |_, q: &[T], _: &[T]| q[0] * q[0] + q[1] * q[1] - T::ratio(4, 5);
    Event::new("circle", g).then(|_, q, p| {
        let normal = (q[0] * p[0] + q[1] * p[1]) / (q[0] * q[0] + q[1] * q[1]);
        p[0] -= T::int(2) * normal * q[0];
        p[1] -= T::int(2) * normal * q[1];
        ControlFlow::Continue(())
    })
}

/// The largest change of the energy from the start to an event, and the number of events.
fn at_events<T: Float>(run: &Run<T>) -> (f64, usize) {
    let start = energy(run.q(0), run.p(0));
    let errors = run
        .events()
        .iter()
        .map(|at| (energy(&at.q, &at.p) - start).abs().to_f64());
    (errors.fold(0.0, f64::max), run.events().len())
}

/// The state on the polynomial of the step had errors of 1e-10 to 1e-5.
#[test]
fn reflections_conserve_the_energy_to_round_off() {
    let (q, p) = ([0.3, 0.2], [0.7, -0.9]);
    let fixed = [(4, 0.1), (4, 0.3), (8, 0.3), (8, 1.0)].map(|(s, h)| Equip::stages(s).step(h));
    let variable = [(8, 1e-6), (3, 1e-6), (8, 1e-12)].map(|(s, by)| Equip::stages(s).tolerance(by));
    for options in fixed.into_iter().chain(variable) {
        let options = options.event(wall(-0.5)).event(circle());
        let run = options.integrate(&quartic(), &q, &p, 0.0..=400.0).unwrap();
        let (error, count) = at_events(&run);
        assert!(error < 1e-13 && count > 250, "{error:e} at {count} events");
        assert!(run.certificate().energy_conserved_on_every_step());
    }
    let wide = |x: f64| DoubleDouble::from(x);
    let events = [wall(wide(-0.5)), circle()];
    let options = Equip::stages(8).step(wide(0.1));
    let (q, p) = (q.map(wide), p.map(wide));
    let mut run = options.start(&quartic(), &q, &p, wide(0.0)).unwrap();
    let mut found = StepEvents::new(&quartic(), &mut run, &events).unwrap();
    let (start, mut count) = (energy(&q, &p), 0);
    while run.time() < wide(20.0) {
        run.advance().unwrap();
        for at in found.find(&mut run).unwrap() {
            count += 1;
            let error = (energy(&at.q, &at.p) - start).abs();
            assert!(error < wide(1e-29), "{:e}", error.to_f64());
        }
    }
    assert!(count > 10);
}

/// The state at which an event ends a run conserves the angular momentum, with any method.
#[test]
fn the_end_of_a_run_conserves_quadratic_invariants() {
    let kepler = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    })
    .unwrap();
    for s in [2, 4, 8] {
        let end = Event::new("end", |_, q: &[f64], _: &[f64]| q[0] + 0.7).terminal();
        let run = Gauss::stages(s)
            .step(0.1)
            .event(end)
            .integrate(&kepler, &[0.4, 0.0], &[0.0, 2.0], 0.0..=20.0)
            .unwrap();
        let (_, q, p) = run.last();
        assert!(run.stopped() && (q[0] + 0.7).abs() < 1e-15);
        let error = q[0] * p[1] - q[1] * p[0] - 0.8;
        assert!(error.abs() < 1e-15, "s = {s}: {error:e}");
    }
}

/// A wall close to the largest q_0 of the motion reflects once, whatever side rounding puts the particle on.
#[test]
fn a_wall_that_is_touched_is_not_crossed() {
    let ends = |options: &Integrator<f64>, p: &[f64; 2]| {
        let top = Event::new("top", |_, _: &[f64], p: &[f64]| p[0])
            .falling()
            .terminal();
        let run = options.clone().event(top);
        let run = run
            .integrate(&quartic(), &[0.3, 0.2], p, 0.0..=4.0)
            .unwrap();
        run.last().1[0]
    };
    let mut crossed = 0;
    for options in [
        Equip::stages(8).tolerance(1e-6).max_steps(1000),
        Equip::stages(6).tolerance(1e-9).max_steps(1000),
        Equip::stages(8).step(1.0),
    ] {
        for k in 0..4 {
            let p = [0.7 + 0.01 * f64::from(k), -0.9];
            let most = ends(&options, &p);
            for depth in [1e-15, 1e-13, 1e-11, 1e-9, 1e-7] {
                let run = (options.clone().event(wall(most - depth)))
                    .integrate(&quartic(), &[0.3, 0.2], &p, 0.0..=4.0)
                    .unwrap();
                crossed += usize::from(run.events().len() > 10);
            }
        }
    }
    // With roots counted from the time of the change alone: 13.
    assert_eq!(crossed, 0);
}

/// g is rounding near a root of order two on which the run begins.
#[test]
fn a_run_that_begins_on_a_root_does_not_report_it() {
    let oscillator = Hamiltonian::new(1, |q, p| 0.5 * (q[0] * q[0] + p[0] * p[0])).unwrap();
    let top = Event::new("top", |_, q: &[f64], _: &[f64]| q[0] - 1.0);
    for options in [
        Equip::stages(8).tolerance(1e-12),
        Equip::stages(4).step(0.1),
    ] {
        let run = options
            .event(top.clone())
            .integrate(&oscillator, &[1.0], &[0.0], 0.0..=6.0)
            .unwrap();
        assert_eq!(run.events().len(), 0);
    }
    // A ball that stops on a floor at any height falls through it.
    let ball = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + 9.8 * q[0]).unwrap();
    for height in [0.0, 0.1, 1.0, 100.0] {
        let floor = Event::new("floor", move |_, q: &[f64], _: &[f64]| q[0] - height);
        let floor = floor.then(|_, _, p| {
            p[0] = 0.0;
            ControlFlow::Continue(())
        });
        let run = Equip::stages(8)
            .tolerance(1e-12)
            .event(floor)
            .integrate(&ball, &[height + 1.0], &[0.0], 0.0..=2.0)
            .unwrap();
        let fall = (2.0 / 9.8_f64).sqrt();
        assert_eq!(run.events().len(), 1, "at {height}");
        let expected = height - 4.9 * (2.0 - fall).powi(2);
        assert!((run.last().1[0] - expected).abs() < 1e-11 * (1.0 + height));
    }
}

/// Outputs within the step of a bounce, before and after it, are those of the motion that bounces.
#[test]
fn outputs_about_a_bounce() {
    let ball = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + 9.8 * q[0]).unwrap();
    let floor = Event::new("floor", |_, q: &[f64], _: &[f64]| q[0])
        .falling()
        .then(|_, _, p| {
            p[0] = -p[0];
            ControlFlow::Continue(())
        });
    let times: Vec<f64> = (0..173).map(|i| f64::from(i) * 40.0 / 172.0).collect();
    let first = (100.0 / 9.8_f64).sqrt();
    for options in [
        Equip::stages(8).tolerance(1e-10),
        Equip::stages(8).step(0.4),
    ] {
        let run = options
            .event(floor.clone())
            .output_at(&times)
            .integrate(&ball, &[50.0], &[0.0], 0.0..=40.0)
            .unwrap();
        assert_eq!(run.outputs().count(), times.len());
        for (t, q, _) in run.outputs() {
            let since = (t + first) % (2.0 * first) - first;
            let error = q[0] - (50.0 - 4.9 * since * since);
            assert!(error.abs() < 1e-10, "{error:e} at {t}");
        }
    }
}

/// Kicks p += 1/2 at times that are ends of steps, up to the rounding of decimals: each acts once, whether g
/// rises or falls. Between them q = A cos(t − φ).
#[test]
fn kicks_at_the_ends_of_fixed_steps() {
    let oscillator = Hamiltonian::new(1, |q, p| 0.5 * (q[0] * q[0] + p[0] * p[0])).unwrap();
    for (decimals, unit) in [(1, 0.1), (1, 0.2), (2, 0.05), (2, 0.01)] {
        for k in 1..60 {
            let time: f64 = format!("{:.decimals$}", f64::from(k) * unit)
                .parse()
                .unwrap();
            for sign in [1.0, -1.0] {
                let kick = Event::new("kick", move |t, _, _| sign * (t - time));
                let kick = kick.then(|_, _, p| {
                    p[0] += 0.5;
                    ControlFlow::Continue(())
                });
                let end = 65.0 * unit;
                let run = Equip::stages(4)
                    .step(unit)
                    .event(kick)
                    .integrate(&oscillator, &[1.0], &[0.0], 0.0..=end)
                    .unwrap();
                let exact = end.cos() + 0.5 * (end - time).sin();
                let error = run.last().1[0] - exact;
                assert!(error.abs() < 1e-8, "{error:e} with {sign} (t − {time})");
                let certificate = run.certificate();
                assert_eq!((run.events().len(), certificate.state_changes), (1, 1));
                let text = certificate.to_string();
                assert!(
                    text.contains("1; errors are relative to the values after each"),
                    "{text}"
                );
                assert!(text.contains("energy after change"), "{text}");
            }
        }
    }
    // All roots of sin πt, which are such times.
    for step in [0.1, 0.05, 0.25] {
        let beat = Event::new("beat", |t: f64, _, _| (std::f64::consts::PI * t).sin());
        let run = Equip::stages(4).step(step).event(beat);
        let run = run.integrate(&oscillator, &[1.0], &[0.0], 0.0..=50.5);
        assert_eq!(run.unwrap().events().len(), 50, "{step}");
    }
}
