//! A run is the same to the last bit, whatever is watched or kept of it, and it runs backwards.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{
    Alphas, Counts, Equip, Family, Gauss, Invariant, Method, Record, Run, StepView,
};
use equip_scalar::{DoubleDouble, Float};
use equip_tests::{Start, distance, double_pendulum, henon_heiles, kepler};
use std::ops::ControlFlow;

fn methods() -> [Method; 4] {
    [
        Gauss::stages(3),
        Equip::stages(3),
        Equip::stages(4).alphas(Alphas::Last),
        Method::fixed_alpha(3, 0.01),
    ]
}

/// Times, states and outcomes of a run.
fn bits<T: Float>(run: &Run<T>) -> (Vec<T>, Vec<Vec<T>>, Counts) {
    let states = (0..run.len())
        .map(|i| [run.q(i), run.p(i)].concat())
        .collect();
    (run.times().to_vec(), states, run.certificate().counts)
}

fn watched_runs_are_the_same<T: Float>() {
    let (h, start) = kepler::<T>(6);
    let interval = || T::int(0)..=T::int(7);
    for method in methods() {
        // A step that does not divide the interval.
        let plain = method.step(T::ratio(3, 40));
        let reference = plain.integrate(&h, &start.q, &start.p, interval()).unwrap();
        let (times, states, counts) = bits(&reference);
        assert_eq!(times.last(), Some(&T::int(7)));
        let n = states.len() - 1;

        let again = plain.integrate(&h, &start.q, &start.p, interval()).unwrap();
        assert_eq!(bits(&again), (times.clone(), states.clone(), counts));

        let outputs: Vec<T> = (0..=20).map(|k| T::ratio(7 * k, 20)).collect();
        let watched = plain.clone().output_at(&outputs).invariant(Invariant::new(
            "angular momentum",
            Hamiltonian::new(2, |q, p| q[0] * p[1] - q[1] * p[0]).unwrap(),
        ));
        let mut seen = 0;
        let mut observer = |view: &StepView<'_, T>| {
            seen += 1;
            assert_eq!(view.index, seen);
            ControlFlow::Continue(())
        };
        let watched = watched
            .integrate_observed(&h, &start.q, &start.p, interval(), &mut observer)
            .unwrap();
        assert_eq!(seen as usize, n);
        assert_eq!(bits(&watched), (times.clone(), states.clone(), counts));
        assert_eq!(
            watched.outputs().map(|(t, _, _)| t).collect::<Vec<_>>(),
            outputs
        );
        let (_, q, p) = watched.outputs().last().unwrap();
        assert_eq!([q, p].concat(), states[n]);

        let every = plain.clone().record(Record::Every(10));
        let every = every.integrate(&h, &start.q, &start.p, interval()).unwrap();
        let kept: Vec<usize> = (0..n).step_by(10).chain([n]).collect();
        assert_eq!(
            bits(&every).1,
            kept.iter().map(|&i| states[i].clone()).collect::<Vec<_>>()
        );
        let ends = plain.clone().record(Record::Ends);
        let ends = ends.integrate(&h, &start.q, &start.p, interval()).unwrap();
        assert_eq!(bits(&ends).1, [states[0].clone(), states[n].clone()]);
        assert_eq!(bits(&ends).2, counts);

        // Step by step, up to the last whole step of the grid.
        let stepper = plain.start(&h, &start.q, &start.p, T::int(0)).unwrap();
        for (i, step) in stepper.take(n - 1).enumerate() {
            let step = step.unwrap();
            assert_eq!(step.index as usize, i + 1);
            assert_eq!(step.time, times[i + 1]);
            assert_eq!([step.q, step.p].concat(), states[i + 1]);
        }
    }
}

#[test]
fn what_is_watched_changes_no_bit() {
    watched_runs_are_the_same::<f64>();
    watched_runs_are_the_same::<DoubleDouble>();
}

#[test]
fn an_observer_ends_a_run_at_the_state_it_saw() {
    let (h, start) = kepler::<f64>(6);
    let options = Equip::stages(3).step(0.05).record(Record::Ends);
    let mut far = |view: &StepView<'_, f64>| {
        if view.q[0] < -1.0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let run = options
        .integrate_observed(&h, &start.q, &start.p, 0.0..=10.0, &mut far)
        .unwrap();
    assert!(run.stopped() && run.last().0 < 10.0 && run.last().1[0] < -1.0);
    assert_eq!(run.certificate().end, run.last().0);
    let whole = options
        .integrate(&h, &start.q, &start.p, 0.0..=run.last().0)
        .unwrap();
    assert!(!whole.stopped());
    assert_eq!(whole.last(), run.last());
}

#[test]
fn output_times_get_states_of_full_order() {
    let (h, start) = kepler::<f64>(6);
    let outputs = [0.01, 0.999, 1.0, 2.345];
    let run = Equip::stages(6)
        .step(0.05)
        .output_at(&outputs)
        .integrate(&h, &start.q, &start.p, 0.0..=3.0)
        .unwrap();
    assert_eq!(
        run.certificate().output_steps,
        3,
        "one of the times is on the grid"
    );
    for (t, q, p) in run.outputs() {
        let fine = Equip::stages(6)
            .step(t / 200.0)
            .record(Record::Ends)
            .integrate(&h, &start.q, &start.p, 0.0..=t)
            .unwrap();
        let (_, q_fine, p_fine) = fine.last();
        let error = distance(&[q, p].concat(), &[q_fine, p_fine].concat());
        println!("t = {t}: {error:.1e}");
        assert!(error < 1e-12);
    }
}

#[test]
fn time_is_the_grid_not_a_sum() {
    let (h, start) = kepler::<f64>(6);
    let run = Gauss::stages(2)
        .step(0.1)
        .integrate(&h, &start.q, &start.p, 0.0..=100.0)
        .unwrap();
    assert_eq!(run.len(), 1001);
    for (n, &t) in run.times().iter().enumerate() {
        assert_eq!(t, n as f64 * 0.1);
    }
}

/// n steps forward, momenta reversed, n steps back: the distance to the start.
fn there_and_back<T: Float>(
    method: Method,
    h: T,
    steps: usize,
    energy: &Hamiltonian,
    start: &Start<T>,
) -> T {
    let go = |q: &[T], p: &[T]| {
        let mut run = method.step(h).start(energy, q, p, T::int(0)).unwrap();
        for _ in 0..steps {
            run.advance().unwrap();
        }
        let view = run.view();
        (
            view.q.to_vec(),
            view.p.iter().map(|&p| -p).collect::<Vec<T>>(),
        )
    };
    let (q, p) = go(&start.q, &start.p);
    let moved = distance(&[&q[..], &p].concat(), &start.state());
    assert!(moved > T::ratio(1, 100), "it went somewhere");
    let (q, p) = go(&q, &p);
    distance(&[q, p].concat(), &start.state())
}

/// Largest distance to the start after the way back, on Kepler and on the double pendulum.
fn reversal<T: Float>(method: Method) -> f64 {
    let (h, start) = kepler::<T>(6);
    let kepler = there_and_back(method, T::two_pi() / T::int(100), 250, &h, &start).to_f64();
    let (h, start) = double_pendulum::<T>();
    let pendulum = there_and_back(method, T::ratio(1, 50), 50, &h, &start).to_f64();
    println!(
        "{method}, {}: Kepler {kepler:.1e}, double pendulum {pendulum:.1e}",
        T::NAME
    );
    kepler.max(pendulum)
}

#[test]
fn a_run_with_reversed_momenta_returns() {
    for method in methods() {
        let is_equip = matches!(method.family(), Family::Equip(_));
        // Measured 7e-15 to 7.3e-13, with α 1.6e-11 (s = 3), of second order in the displacement;
        // headroom 2.5.
        assert!(reversal::<f64>(method) < if is_equip { 4e-11 } else { 2e-12 });
        if !is_equip {
            // Measured 4e-30; headroom 10.
            assert!(reversal::<DoubleDouble>(method) < 4e-29);
        }
    }
}

#[test]
#[ignore = "known deficit: steps with large alphas do not return to rounding"]
fn steps_with_large_alphas_return() {
    // Measured 7.3e-15 and 4.7e-14; headroom 4. With local errors taken from stages that have not settled
    // 1.5e-13 and 6.4e-13.
    for (s, h, most) in [(4, 0.5, 3e-14), (6, 1.0, 2e-13)] {
        for q2 in ["0.1", "0.102", "0.104", "0.106"] {
            let (energy, start) = henon_heiles::<f64>(0.125, q2, "0.1");
            let off = there_and_back(Equip::stages(s), h, 100, &energy, &start);
            println!("s = {s}, h = {h}, q2 = {q2}: {off:.1e}");
            assert!(off < most);
        }
    }
}

#[test]
#[ignore = "known deficit: 6.4e-9 with s = 3, 4e-28 allowed: steps are symmetric to second order in the displacement"]
fn equip_returns_in_double_double() {
    assert!(reversal::<DoubleDouble>(Equip::stages(3)) < 4e-28);
}

/// Largest distance on the way back to where the way there has been, over n steps: on a closed orbit what
/// single steps are off cancels along the way.
fn off_on_the_way_back<T: Float>(
    s: usize,
    h: &Hamiltonian,
    start: &Start<T>,
    step: T,
    n: usize,
) -> f64 {
    let method = Equip::stages(s).step(step);
    let mut states = vec![start.state()];
    let mut run = method
        .start(h, &start.q, &start.p, step * T::int(0))
        .unwrap();
    for _ in 0..n {
        run.advance().unwrap();
        let view = run.view();
        states.push([view.q, view.p].concat());
    }
    let (q, p) = states[n].split_at(start.q.len());
    let back: Vec<T> = p.iter().map(|&p| -p).collect();
    let mut run = method.start(h, q, &back, step * T::int(0)).unwrap();
    let mut most = 0.0_f64;
    for state in states[..n].iter().rev() {
        run.advance().unwrap();
        let view = run.view();
        let p: Vec<T> = view.p.iter().map(|&p| -p).collect();
        most = most.max(distance(&[view.q, &p].concat(), state).to_f64());
    }
    println!(
        "s = {s}, {n} steps: {most:.1e}, {} left to Newton",
        run.counts().preconditioner_changes
    );
    most
}

fn part_of_a_period<T: Float>(n: i64) -> T {
    T::two_pi() / T::int(n)
}

/// Where α displaces y1 by less than 1e-14 every step returns to rounding: the step is symmetric to second
/// order in the displacement.
#[test]
fn small_displacements_return_in_double_double() {
    let (h, start) = kepler::<DoubleDouble>(6);
    for (s, n) in [(4, 1500), (6, 400)] {
        let step = part_of_a_period::<DoubleDouble>(n);
        assert!(off_on_the_way_back(s, &h, &start, step, 20) < 1e-27);
    }
}

/// Also where the local error is 1e-3 of the orbit, whose square is not to be seen.
#[test]
#[ignore = "known deficit: 1.8e-9 with s = 3 and 100 steps a period, 1e-27 allowed: the displacement is large"]
fn every_step_returns_in_double_double() {
    let (h, start) = kepler::<DoubleDouble>(6);
    for (s, n) in [
        (3, 100),
        (4, 96),
        (6, 24),
        (6, 48),
        (8, 16),
        (8, 24),
        (12, 10),
        (12, 16),
        (16, 8),
        (16, 12),
    ] {
        let step = part_of_a_period::<DoubleDouble>(n);
        assert!(off_on_the_way_back(s, &h, &start, step, n as usize) < 1e-27);
    }
    let (h, start) = double_pendulum::<DoubleDouble>();
    for (s, n) in [(4, 50), (8, 20)] {
        assert!(off_on_the_way_back(s, &h, &start, DoubleDouble::ratio(1, n), n as usize) < 1e-27);
    }
}

#[test]
#[ignore = "known deficit: 7.4e-29 on Kepler, 1.1e-20 on the double pendulum, 4e-28 allowed"]
fn the_last_alpha_returns_in_double_double() {
    let method = Equip::stages(4).alphas(Alphas::Last);
    assert!(reversal::<DoubleDouble>(method) < 4e-28);
}
