//! Events that change the state at the same time, again at once, or to a state that H does not have.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Event, IntegrateError, Record, StepEvents};
use std::f64::consts::PI;
use std::ops::ControlFlow;

const G: f64 = 9.8;

/// Two balls that do not know of each other.
fn balls() -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) + G * (q[0] + q[1])
    })
    .unwrap()
}

fn floor(ball: usize) -> Event<f64> {
    Event::new("floor", move |_, q: &[f64], _| q[ball])
        .falling()
        .then(move |_, _, p| {
            p[ball] = -p[ball];
            ControlFlow::Continue(())
        })
}

/// The height of a ball that was dropped from `height` and bounces.
fn bouncing(height: f64, t: f64) -> f64 {
    let fall = (2.0 * height / G).sqrt();
    let since = (t + fall).rem_euclid(2.0 * fall) - fall;
    height - G * since * since / 2.0
}

/// Balls from heights that are equal, or differ by rounding or by more. Measured: 2e-14.
#[test]
fn all_events_at_a_time_change_the_state() {
    for difference in [0.0, 1e-15, 3e-14, 1e-12, 1e-9, 1e-3] {
        let heights = [1.0, 1.0 + difference];
        let run = Equip::stages(4)
            .tolerance(1e-12)
            .event(floor(0))
            .event(floor(1))
            .integrate(&balls(), &heights, &[0.0, 0.0], 0.0..=2.0)
            .unwrap();
        let (_, q, _) = run.last();
        for (q, height) in q.iter().zip(heights) {
            let error = (q - bouncing(height, 2.0)).abs();
            assert!(error < 1e-12, "{difference:e}: {error:e}");
        }
        assert_eq!(run.events().len(), 4, "{difference:e}");
    }
}

/// An event that only watches is found once, before the one that changes the state in the list or behind it.
#[test]
fn events_at_the_time_of_a_change_are_found_once() {
    let ball = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + G * q[0]).unwrap();
    let watch = || Event::new("watch", |_, q: &[f64], _: &[f64]| q[0]).falling();
    for events in [[watch(), floor(0)], [floor(0), watch()]] {
        let options = Equip::stages(4).step(0.3);
        let all = events.clone();
        let [first, second] = events;
        let run = (options.clone().event(first).event(second))
            .integrate(&ball, &[1.0], &[0.0], 0.0..=2.0)
            .unwrap();
        let count = |event| run.events().iter().filter(|e| e.event == event).count();
        assert_eq!([count(0), count(1)], [2, 2]);
        let mut steps = options.start(&ball, &[1.0], &[0.0], 0.0).unwrap();
        let mut events = StepEvents::new(&ball, &mut steps, &all).unwrap();
        let mut found = [0, 0];
        while steps.time() < 2.0 {
            steps.advance().unwrap();
            for event in events.find(&mut steps).unwrap() {
                found[event.event] += 1;
            }
        }
        assert_eq!(found, [2, 2]);
    }
}

/// The standard map: a free rotor that is kicked at every whole time, from random states and times. A kick
/// that is found twice shows in p; rounding of the time of a kick grows with the chaos of the map.
#[test]
fn a_kick_is_found_once() {
    let rotor = Hamiltonian::new(1, |_, p| 0.5 * p[0] * p[0]).unwrap();
    let mut seed = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    for _ in 0..100 {
        let (begin, period) = (random() - 0.5, 0.2 + random());
        let (q0, p0) = (6.0 * random(), random() - 0.5);
        let clock = Event::new("clock", move |t: f64, _: &[f64], _: &[f64]| {
            (PI * t / period).sin()
        });
        let kick = clock.clone().then(|_, q: &mut [f64], p: &mut [f64]| {
            p[0] += 0.3 * q[0].sin();
            ControlFlow::Continue(())
        });
        let end = 40.5 * period;
        let run = Equip::stages(3)
            .tolerance(1e-10)
            .event(clock)
            .event(kick)
            .integrate(&rotor, &[q0], &[p0], begin..=end)
            .unwrap();
        let (mut q, mut p, mut t) = (q0, p0, begin);
        let mut kicks = 0;
        for k in (begin / period).floor() as i64..=40 {
            let at = k as f64 * period;
            if at > begin {
                (q, t) = (q + p * (at - t), at);
                p += 0.3 * q.sin();
                kicks += 1;
            }
        }
        q += p * (end - t);
        let (_, found_q, found_p) = run.last();
        assert_eq!(run.events().len(), 2 * kicks);
        let error = (found_q[0] - q).abs().max((found_p[0] - p).abs());
        assert!(error < 1e-9, "from {q0}, {p0} at {begin}: {error:e}");
    }
}

/// A particle in a circle that reflects it, wherever it meets it and on whichever side of it rounding ends.
#[test]
fn walls_met_in_any_direction_reflect_once() {
    let free = Hamiltonian::new(2, |_, p| 0.5 * (p[0] * p[0] + p[1] * p[1])).unwrap();
    for k in 0..40 {
        let wall = Event::new("wall", |_, q: &[f64], _: &[f64]| {
            q[0] * q[0] + q[1] * q[1] - 1.0
        })
        .then(|_, q: &mut [f64], p: &mut [f64]| {
            let along = (p[0] * q[0] + p[1] * q[1]) / (q[0] * q[0] + q[1] * q[1]);
            (p[0], p[1]) = (p[0] - 2.0 * along * q[0], p[1] - 2.0 * along * q[1]);
            ControlFlow::Continue(())
        });
        let angle = 0.157 * f64::from(k);
        let (q, p) = ([0.3, 0.1], [angle.cos(), angle.sin()]);
        let run = (Equip::stages(2).tolerance(1e-10).event(wall))
            .integrate(&free, &q, &p, 0.0..=50.0)
            .unwrap();
        let (_, q_end, p_end) = run.last();
        // The angular momentum, and with it the distance of the chord, is conserved by reflections.
        let momentum = |q: &[f64], p: &[f64]| q[0] * p[1] - q[1] * p[0];
        assert!((momentum(&q, &p) - momentum(q_end, p_end)).abs() < 1e-11);
        assert!(q_end[0].hypot(q_end[1]) < 1.0 + 1e-12);
        // Chords of this length, one after the other.
        let chord = 2.0 * (1.0 - momentum(&q, &p).powi(2)).sqrt();
        let along = q[0] * p[0] + q[1] * p[1];
        let expected = ((50.0 + along + chord / 2.0) / chord).floor() as usize;
        assert_eq!(run.events().len(), expected, "{angle}");
    }
}

#[test]
fn a_state_that_cannot_be_ends_the_run_at_the_event() {
    let ball = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + G * q[0]).unwrap();
    let broken = Event::new("broken floor", |_, q: &[f64], _: &[f64]| q[0])
        .falling()
        .then(|_, q: &mut [f64], _: &mut [f64]| {
            q[0] = f64::NAN;
            ControlFlow::Continue(())
        });
    let failure = (Equip::stages(4).step(0.25).event(broken))
        .integrate(&ball, &[1.0], &[0.0], 0.0..=3.0)
        .unwrap_err();
    let run = failure.partial.unwrap();
    let (t, q, _) = run.last();
    assert!((t - (2.0 / G).sqrt()).abs() < 1e-14 && q[0].abs() < 1e-14);
    assert!(!run.stopped());
    assert!(matches!(failure.error, IntegrateError::ChangedState { .. }));
    assert!(failure.error.to_string().contains("broken floor"));
}

/// A ball that loses half of its speed in every bounce has infinitely many bounces before t = 3 √(2/g).
#[test]
fn bounces_that_accumulate_are_named() {
    let ball = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + G * q[0]).unwrap();
    let soft = Event::new("soft floor", |_, q: &[f64], _: &[f64]| q[0])
        .falling()
        .then(|_, _, p: &mut [f64]| {
            p[0] *= -0.5;
            ControlFlow::Continue(())
        });
    let failure = (Equip::stages(4).tolerance(1e-12).event(soft))
        .integrate(&ball, &[1.0], &[0.0], 0.0..=5.0)
        .unwrap_err();
    let IntegrateError::ChangedState { event, time, cause } = failure.error else {
        panic!("{}", failure.error);
    };
    assert!(event == "soft floor" && cause.contains("accumulate"));
    assert!((time - 3.0 * (2.0 / G).sqrt()).abs() < 1e-12, "{time}");
}

/// One step integrates a free fall exactly, whatever its size. The steps must not grow from bounce to bounce:
/// the state at an event is as accurate as rounding of the change over its step.
#[test]
fn bounces_of_a_motion_that_every_step_integrates_exactly() {
    let ball = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + 9.8 * q[0]).unwrap();
    let floor = Event::new("floor", |_, q: &[f64], _: &[f64]| q[0]).falling();
    let floor = floor.then(|_, _, p| {
        p[0] = -p[0];
        ControlFlow::Continue(())
    });
    let fall = (2.0_f64 / 9.8).sqrt();
    let method = Equip::stages(8).tolerance(1e-10);
    let run = method.clone().event(floor.clone());
    let run = run.integrate(&ball, &[1.0], &[0.0], 0.0..=1e3).unwrap();
    assert_eq!(run.events().len(), 1107);
    for (k, bounce) in run.events().iter().enumerate() {
        let exact = fall * (2 * k + 1) as f64;
        assert!((bounce.time - exact).abs() < 1e-10, "{k} {}", bounce.time);
    }
    let mut run = method.start(&ball, &[1.0], &[0.0], 0.0).unwrap();
    let mut events = StepEvents::new(&ball, &mut run, &[floor]).unwrap();
    for _ in 0..100 {
        run.advance().unwrap();
        events.find(&mut run).unwrap();
        let (q, p) = (run.view().q[0], run.view().p[0]);
        assert!((p * p / 2.0 + 9.8 * q - 9.8).abs() < 1e-11, "{q} {p}");
    }
}

/// A particle between two walls, forward and back to its start, and an event that only watches.
#[test]
fn events_of_a_run_that_turns_back() {
    let free = Hamiltonian::new(1, |_, p| p[0] * p[0] / 2).unwrap();
    let wall = |at: f64| {
        let wall = Event::new("wall", move |_, q: &[f64], _: &[f64]| q[0] - at);
        wall.then(|_, _, p| {
            p[0] = -p[0];
            ControlFlow::Continue(())
        })
    };
    let middle = Event::new("middle", |_, q: &[f64], _: &[f64]| q[0] - 0.5);
    for method in [
        Equip::stages(4).step(0.3),
        Equip::stages(4).tolerance(1e-10),
    ] {
        let mut run = method.start(&free, &[0.3], &[1.0], 0.0).unwrap();
        let of_run = [wall(0.0), wall(1.0), middle.clone()];
        let mut events = StepEvents::new(&free, &mut run, &of_run).unwrap();
        // The walls at 0.7, 1.7, …, the middle at 0.2, 1.2, …
        for end in [10.4, 0.0, -10.4, 0.0] {
            let mut found = [0; 3];
            while run.advance_towards(end).unwrap() {
                for occurrence in events.find(&mut run).unwrap() {
                    found[occurrence.event] += 1;
                }
            }
            let expected = if end == -10.4 || run.time() == 0.0 && found[0] == 6 {
                [6, 5, 10]
            } else {
                [5, 5, 11]
            };
            assert_eq!(found, expected, "to {end}");
        }
        assert!((run.view().q[0] - 0.3).abs() < 1e-12 && run.view().p[0] == 1.0);
    }
}

/// Steps of a free rotor grow to hundreds of revolutions. All roots are found.
#[test]
fn many_roots_in_one_step() {
    let rotor = Hamiltonian::new(1, |_, p| p[0] * p[0] / 2).unwrap();
    let zero = Event::new("zero", |_, q: &[f64], _: &[f64]| q[0].sin());
    let method = Equip::stages(4)
        .tolerance(1e-10)
        .record(Record::Ends)
        .event(zero);
    let run = method.integrate(&rotor, &[0.1], &[1.0], 0.0..=1e4).unwrap();
    assert_eq!(run.events().len(), 3183);
    for (k, root) in run.events().iter().enumerate() {
        let exact = std::f64::consts::PI * (k + 1) as f64 - 0.1;
        assert!((root.time - exact).abs() < 1e-11, "{k} {}", root.time);
    }
}
