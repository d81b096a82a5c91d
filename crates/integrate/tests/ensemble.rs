//! Ensembles: every row is a run of its own bit for bit, whatever the threads; starts are drawn by number.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, IntegrateError, Integrator, Run, RunFailure, Starts, drawn_start};
use equip_scalar::{DoubleDouble, Float};
use rayon::ThreadPoolBuilder;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

fn pendulum() -> Hamiltonian {
    Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap()
}

fn pushed() -> Hamiltonian {
    let energy = |t: equip_autodiff::Var, q: &[_], p: &[_]| {
        let (q, p): (equip_autodiff::Var, equip_autodiff::Var) = (q[0], p[0]);
        0.5 * (p * p + q * q) - q * (0.5 * t).cos()
    };
    Hamiltonian::with_time(1, energy).unwrap()
}

/// End and steps of a run.
fn end(run: Result<Run<f64>, RunFailure<f64>>) -> Option<(f64, f64, u64)> {
    let run = run.ok()?;
    let (_, q, p) = run.last();
    Some((q[0], p[0], run.certificate().counts.steps))
}

fn bits_are_those_of_single_runs(options: &Integrator<f64>) {
    // The last start is none.
    let q: Vec<f64> = (0..40)
        .map(|i| 0.05 * f64::from(i))
        .chain([f64::NAN])
        .collect();
    let p = vec![0.5; q.len()];
    for h in [pendulum(), pushed()] {
        let single = |i: usize| end(options.integrate(&h, &q[i..=i], &p[i..=i], 0.0..=20.0));
        let expected: Vec<_> = (0..q.len()).map(|i| Some(single(i))).collect();
        assert_eq!(expected[40], Some(None));
        for threads in [1, 2, 3, 7] {
            let pool = ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let starts = Starts::new(&q, &p, 0.0..=20.0);
            let work = || options.ensemble(&h, starts, |_, run| end(run), || false);
            assert_eq!(pool.install(work).unwrap(), expected);
        }
    }
}

#[test]
fn rows_are_runs_of_their_own() {
    bits_are_those_of_single_runs(&Equip::stages(4).step(0.1));
    bits_are_those_of_single_runs(&Equip::stages(8).tolerance(1e-10));
}

#[test]
fn they_stop_when_they_are_told_to() {
    let (q, p) = ([0.5; 20], [0.0; 20]);
    let (asked, h) = (AtomicUsize::new(0), pendulum());
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let options = Equip::stages(4).step(0.125);
    let starts = Starts::new(&q, &p, 0.0..=10.0);
    // 80 steps a run, and a question before each run and after each step: the third run is cut.
    let stop = || asked.fetch_add(1, Relaxed) >= 200;
    let rows = pool.install(|| options.ensemble(&h, starts, |i, _| i, stop));
    let rows = rows.unwrap();
    assert_eq!(rows[..3], [Some(0), Some(1), None]);
    assert!(rows[3..].iter().all(Option::is_none));
}

#[test]
fn faults_of_all_runs_are_found_at_once() {
    let h = pendulum();
    let ensemble = |options: &Integrator<f64>, q: &[f64], p: &[f64]| {
        let starts = Starts::new(q, p, 0.0..=1.0);
        options.ensemble(&h, starts, |i, _| i, || false)
    };
    let options = Equip::stages(4).step(0.1);
    let wrong = ensemble(&options, &[0.0, 1.0], &[0.0]);
    assert!(matches!(
        wrong,
        Err(IntegrateError::WrongLength {
            what: "p0",
            expected: 2,
            found: 1
        })
    ));
    assert!(ensemble(&Equip::stages(99).step(0.1), &[], &[]).is_err());
    assert_eq!(ensemble(&options, &[], &[]), Ok(vec![]));
}

#[test]
fn starts_are_drawn_by_seed_and_number() {
    let draw = |seed, index| drawn_start(&[3.0, 0.0], &[-0.5, 1e9], 0.25, seed, index);
    let mut sums = [0.0; 3];
    for index in 0..1000 {
        let (q, p) = draw(1, index);
        assert_eq!(q[1], 0.0);
        let u = [q[0] / 3.0, p[0] / -0.5, p[1] / 1e9].map(|x| (x - 1.0) / 0.25);
        assert!(u.iter().all(|u| u.abs() <= 1.0 + 1e-12));
        for (sum, x) in sums.iter_mut().zip([u[0], u[0] * u[0], u[0] * u[2]]) {
            *sum += x / 1000.0;
        }
    }
    // Uniform in [−1, 1): means 0, 1/3 and 0, their deviations 0.018, 0.0094 and 0.011; four of them.
    println!("{sums:?}");
    assert!(sums[0].abs() < 0.073 && (sums[1] - 1.0 / 3.0).abs() < 0.038 && sums[2].abs() < 0.042);
    assert_eq!(draw(1, 7), draw(1, 7));
    assert_ne!(draw(1, 7), draw(2, 7));
    assert_ne!(draw(1, 7), draw(1, u64::MAX));
    // The same start in double-double, to the rounding of doubles.
    let int = DoubleDouble::int;
    let (q, _) = drawn_start(&[int(3)], &[int(1)], DoubleDouble::ratio(1, 4), 1, 7);
    assert!((q[0].to_f64() - draw(1, 7).0[0]).abs() < 1e-15);
}
