//! Gradients written by hand, held against H along runs.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Gauss, IntegrateError, Outcome, Stepper};
use std::sync::atomic::{AtomicU64, Ordering};

fn pendulum() -> Hamiltonian {
    Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap()
}

/// sin q, with the wrong sign beyond `limit`.
fn wrong_beyond(limit: f64, q: f64) -> f64 {
    if q > limit { -q.sin() } else { q.sin() }
}

/// A wrong sign is found before the first step, whatever makes the steps.
#[test]
fn a_wrong_sign_is_found_at_the_start() {
    let wrong = pendulum().with_gradient(|q, p, dq, dp| (dq[0], dp[0]) = (-q[0].sin(), p[0]));
    let expected = IntegrateError::WrongGradient {
        time: 2.0,
        what: "q",
        index: 0,
        given: -0.5_f64.sin(),
        expected: 0.5_f64.sin(),
    };
    let fixed = Equip::stages(4)
        .step(0.1)
        .start(&wrong, &[0.5], &[0.3], 2.0);
    let error = fixed.map(|_| ()).unwrap_err();
    println!("{error}");
    for part in ["t = 2", "∂H/∂q[0]", "4.794", "correct the gradient"] {
        assert!(error.to_string().contains(part), "{part}: {error}");
    }
    assert_eq!(error, expected);
    let variable = Gauss::stages(4).tolerance(1e-8);
    let failure = variable
        .integrate(&wrong, &[0.5], &[0.3], 2.0..=3.0)
        .unwrap_err();
    assert_eq!(failure.error, expected);
    assert!(failure.partial.is_none());
}

/// A momentum's component, and one that is right where the run starts.
#[test]
fn a_gradient_that_is_wrong_elsewhere_is_found_on_the_way() {
    // From q = 0 with the speed 1: q = 0.6 is reached at t = 0.62.
    let wrong =
        pendulum().with_gradient(|q, p, dq, dp| (dq[0], dp[0]) = (wrong_beyond(0.6, q[0]), p[0]));
    let found = |error: &IntegrateError<f64>| match error {
        IntegrateError::WrongGradient {
            time,
            what,
            index,
            given,
            expected,
        } => {
            assert_eq!((*what, *index), ("q", 0));
            assert!(
                (given + expected).abs() < 1e-12 && *expected > 0.5,
                "{error}"
            );
            assert!(*time > 0.6 && *time < 1.3, "{error}");
        }
        other => panic!("{other}"),
    };
    for method in [Equip::stages(4), Gauss::stages(4)] {
        let failure = method
            .step(0.01)
            .integrate(&wrong, &[0.0], &[1.0], 0.0..=2.0);
        let failure = failure.unwrap_err();
        found(&failure.error);
        // The state before the step that was not made.
        let partial = failure.partial.unwrap();
        assert!(partial.last().0 > 0.6 && partial.last().0 < 1.3);
    }
    let failure = Equip::stages(4)
        .tolerance(1e-9)
        .first_step(0.01)
        .max_step(0.01)
        .integrate(&wrong, &[0.0], &[1.0], 0.0..=2.0)
        .unwrap_err();
    found(&failure.error);

    // Taken as it is.
    let unchecked = Gauss::stages(4).step(0.01).check_gradient(false);
    let run = unchecked
        .integrate(&wrong, &[0.0], &[1.0], 0.0..=2.0)
        .unwrap();
    assert_eq!(run.last().0, 2.0);
}

/// At a kink either side's derivative is right.
#[test]
fn a_start_on_a_kink_is_no_fault() {
    let wedge = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + q[0].abs()).unwrap();
    for at_kink in [-1.0, 0.0, 1.0] {
        let given = wedge.clone().with_gradient(move |q, p, dq, dp| {
            dq[0] = if q[0] == 0.0 { at_kink } else { q[0].signum() };
            dp[0] = p[0];
        });
        let start = Equip::stages(4)
            .step(0.1)
            .start(&given, &[0.0], &[1.0], 0.0);
        assert!(start.is_ok(), "{at_kink}");
    }
}

/// A right gradient is not found wrong, and costs the run nothing that is counted.
#[test]
fn a_right_gradient_is_left_alone() {
    let right = pendulum().with_gradient(|q, p, dq, dp| (dq[0], dp[0]) = (q[0].sin(), p[0]));
    let counts = |check: bool| {
        let options = Equip::stages(4).step(0.1).check_gradient(check);
        let run = options
            .integrate(&right, &[2.0], &[0.0], 0.0..=100.0)
            .unwrap();
        run.certificate().counts
    };
    assert_eq!(counts(true), counts(false));
}

/// A pendulum computed from outside, whose force has the wrong sign beyond `limit`.
fn external(limit: f64) -> Hamiltonian {
    Hamiltonian::external(
        1,
        f64::EPSILON,
        |q, p| 0.5 * p[0] * p[0] - q[0].cos(),
        move |q, p, dq, dp| (dq[0], dp[0]) = (wrong_beyond(limit, q[0]), p[0]),
    )
    .unwrap()
}

#[test]
fn an_external_gradient_is_checked_by_differences() {
    let options = Gauss::stages(4).step(0.01);
    let failure = options
        .integrate(&external(0.6), &[0.0], &[1.0], 0.0..=2.0)
        .unwrap_err();
    match failure.error {
        IntegrateError::WrongGradient {
            what,
            index,
            given,
            expected,
            ..
        } => {
            assert_eq!((what, index), ("q", 0));
            assert!((given + expected).abs() < 1e-6, "{given} {expected}");
        }
        other => panic!("{other}"),
    }
    // Right ones are let through, at rest and far out.
    for q in [0.0, 1.0, 1e-9, 3e5] {
        let run = options.integrate(&external(f64::INFINITY), &[q], &[1.0], 0.0..=1.0);
        assert!(run.is_ok(), "{q}");
    }
}

/// An external energy is conserved to round-off, and its orbit is that of the recorded one: fixed steps, by
/// tolerance, and steps that need ∇²H.
#[test]
fn an_external_energy_is_conserved() {
    let (q, p) = ([2.0], [0.3]);
    for (h, limit) in [(0.1, 1e-13), (0.5, 1e-12)] {
        let options = Equip::stages(4).step(h);
        let outside = options
            .integrate(&external(9.0), &q, &p, 0.0..=50.0)
            .unwrap();
        let recorded = options.integrate(&pendulum(), &q, &p, 0.0..=50.0).unwrap();
        let off = (outside.last().1[0] - recorded.last().1[0]).abs();
        println!("h = {h}: off by {off:.1e}");
        assert!(off < limit, "h = {h}: {off}");
        assert!(outside.certificate().energy_conserved_on_every_step());
    }
    let run = Equip::stages(6).tolerance(1e-10);
    let run = run.integrate(&external(9.0), &q, &p, 0.0..=50.0).unwrap();
    assert!(run.certificate().energy_conserved_on_every_step());
}

/// Of values to 1e-7, as in single precision, no more is conserved than they say: α is not solved for their
/// noise.
#[test]
fn the_noise_of_an_external_energy_is_left_alone() {
    let single = Hamiltonian::external(
        1,
        6e-8,
        |q, p| f64::from((0.5 * p[0] * p[0] + 2.0 - q[0].cos()) as f32),
        |q, p, dq, dp| (dq[0], dp[0]) = (q[0].sin(), p[0]),
    );
    let single = single.unwrap();
    let run = Equip::stages(6).step(0.1);
    let run = run.integrate(&single, &[2.0], &[0.3], 0.0..=50.0).unwrap();
    let counts = run.certificate().counts;
    println!("{counts:?}");
    assert_eq!(counts.outcome(Outcome::Solved), 0);
    assert!(run.certificate().energy_conserved_on_every_step());
}

/// A step of two parts, up to a kink and from there, whose second part fails leaves the largest floor of late
/// as it was: that of the well from which the run came.
#[test]
fn a_step_that_fails_in_its_second_part_forgets_no_floor() {
    let energy = |kink: f64| {
        let h = Hamiltonian::new(1, |q, p| {
            let well = 100.0 / (1.0 + 100.0 * q[0] * q[0]);
            0.5 * p[0] * p[0] - well + (q[0] - kink).max(0.0).powi(2)
        });
        h.unwrap()
    };
    fn after_128_steps(h: &Hamiltonian) -> Stepper<f64> {
        let options = Equip::stages(4).step(0.002).max_halvings(0);
        let run = options.start(h, &[0.0], &[201_f64.sqrt()], 0.0);
        let mut run = run.unwrap();
        for _ in 0..128 {
            run.advance().unwrap();
        }
        run
    }
    fn round_off_back(run: &mut Stepper<f64>) -> f64 {
        run.turn_back();
        run.advance().unwrap().energy_round_off.unwrap()
    }
    let mut smooth = after_128_steps(&energy(9.0));
    let from = smooth.view().q[0];
    let step = smooth.advance().unwrap().q[0] - from;
    let kink = from + 0.5 * step;
    // The third of four stages from the kink on, at 0.5 + 0.67/2, is beside those of the whole step.
    let hole = from + 0.835 * step;
    let holed = energy(kink).with_gradient(move |q, p, dq, dp| {
        let slope = 2e4 * q[0] / (1.0 + 100.0 * q[0] * q[0]).powi(2);
        dq[0] = slope + 2.0 * (q[0] - kink).max(0.0);
        if (q[0] - hole).abs() < 0.01 * step {
            dq[0] = f64::NAN;
        }
        dp[0] = p[0];
    });
    let mut run = after_128_steps(&holed);
    let error = run.advance().unwrap_err();
    let IntegrateError::NotFinite { time, .. } = error else {
        panic!("{error}");
    };
    // It began at the kink.
    assert!((time - 0.257).abs() < 1e-5, "{error}");
    let mut smooth = after_128_steps(&energy(9.0));
    let (round_off, of_late) = (round_off_back(&mut run), round_off_back(&mut smooth));
    println!("{round_off:e} {of_late:e}");
    assert!(round_off > 0.9 * of_late);
}

/// ∇²H of an external energy is computed of gradients, and the certificate counts these.
#[test]
fn gradients_of_differences_are_counted() {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    let external = Hamiltonian::external(
        1,
        f64::EPSILON,
        |q, p| 0.5 * p[0] * p[0] - q[0].cos(),
        |q, p, dq, dp| {
            CALLS.fetch_add(1, Ordering::Relaxed);
            (dq[0], dp[0]) = (q[0].sin(), p[0]);
        },
    );
    let method = Equip::stages(3).step(0.1);
    let run = method.integrate(&external.unwrap(), &[1.0], &[0.0], 0.0..=20.0);
    let counts = run.unwrap().certificate().counts;
    let calls = CALLS.load(Ordering::Relaxed);

    assert!(counts.hessians > 0);
    assert!(
        (calls - 100..=calls).contains(&counts.gradients),
        "{calls} calls, {counts:?}"
    );
}
