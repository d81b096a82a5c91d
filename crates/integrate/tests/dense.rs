//! Dense output: its order, its error beside that of the steps, and that the steps do not feel it.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Preconditioner, Record, Run, Trajectory};
use equip_scalar::{DoubleDouble, Float, ratio};

fn henon_heiles() -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        let squares = p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1];
        0.5 * squares + q[0] * q[0] * q[1] - ratio(1, 3) * q[1].powi(3)
    })
    .unwrap()
}

/// q = (0, 0.1), p = (0.5, 0): a regular orbit.
fn start<T: Float>() -> ([T; 2], [T; 2]) {
    let zero = T::int(0);
    ([zero, T::ratio(1, 10)], [T::ratio(1, 2), zero])
}

fn largest<T: Float>(a: (&[T], &[T]), b: (&[T], &[T])) -> f64 {
    let pairs = a.0.iter().chain(a.1).zip(b.0.iter().chain(b.1));
    pairs.fold(0.0, |most, (&x, &y)| most.max((x - y).abs().to_f64()))
}

fn dd(x: &[f64]) -> Vec<DoubleDouble> {
    x.iter().map(|&x| DoubleDouble::exact(x)).collect()
}

/// The run at 64 times per unit of time in double-double, to 1e-25.
fn reference(times: &[f64]) -> Vec<(Vec<DoubleDouble>, Vec<DoubleDouble>)> {
    let (q, p) = start::<DoubleDouble>();
    let end = DoubleDouble::exact(10.0);
    let options = Equip::stages(12)
        .tolerance(DoubleDouble::decimal("1e-26").unwrap())
        .output_at(&dd(times))
        .record(Record::Ends);
    let run = options
        .integrate(&henon_heiles(), &q, &p, DoubleDouble::exact(0.0)..=end)
        .unwrap();
    run.outputs()
        .map(|(_, q, p)| (q.to_vec(), p.to_vec()))
        .collect()
}

fn times() -> Vec<f64> {
    (0..=640).map(|i| f64::from(i) / 64.0).collect()
}

/// Errors at the grid points and between them, largest over the run in double-double with steps h.
fn errors(s: usize, h: f64, reference: &[(Vec<DoubleDouble>, Vec<DoubleDouble>)]) -> (f64, f64) {
    let (q, p) = start::<DoubleDouble>();
    let zero = DoubleDouble::exact(0.0);
    let run = Equip::stages(s)
        .step(DoubleDouble::exact(h))
        .dense()
        .integrate(&henon_heiles(), &q, &p, zero..=DoubleDouble::exact(10.0))
        .unwrap();
    let trajectory = run.trajectory().unwrap();
    let (mut at_steps, mut between) = (0.0f64, 0.0f64);
    for (&t, (q, p)) in times().iter().zip(reference) {
        let (q1, p1) = trajectory.at(DoubleDouble::exact(t)).unwrap();
        let error = largest((q, p), (&q1, &p1));
        if t % h == 0.0 {
            at_steps = at_steps.max(error);
        } else {
            between = between.max(error);
        }
    }
    (at_steps, between)
}

#[test]
fn order_and_error_beside_the_steps() {
    let reference = reference(&times());
    let mut table = String::from("| s | order | error over that of the steps |\n|---|---|---|\n");
    for s in [2, 3, 4] {
        let (coarse_steps, coarse) = errors(s, 0.25, &reference);
        let (fine_steps, fine) = errors(s, 0.125, &reference);
        let order = (coarse / fine).log2();
        let most = (coarse / coarse_steps).max(fine / fine_steps);
        table += &format!("| {s} | {order:.2} | {most:.2} |\n");
        // Measured 3.97, 5.87, 8.55: order 2s (α's that aim at the exact flow take the more off the error the
        // smaller the step), and at most 1.02 times the error of the steps.
        let above = order - 2.0 * s as f64;
        assert!(above > -0.5 && above < 1.0, "order {order}");
        assert!(most < 2.0);
    }
    println!("\n{table}");
}

#[test]
fn adaptive_output_has_the_accuracy_of_the_steps() {
    let times = times();
    let reference = reference(&times);
    let (q, p) = start::<f64>();
    let options = Equip::stages(6).tolerance(1e-9);
    let run = options
        .clone()
        .output_at(&times)
        .integrate(&henon_heiles(), &q, &p, 0.0..=10.0)
        .unwrap();
    let mut worst = 0.0f64;
    let mut count = 0;
    for ((t, q, p), (time, (q1, p1))) in run.outputs().zip(times.iter().zip(&reference)) {
        assert_eq!(t, *time);
        worst = worst.max(largest((&dd(q), &dd(p)), (q1, p1)));
        count += 1;
    }
    assert_eq!(count, times.len());
    let (_, q, p) = run.last();
    let end = reference.last().unwrap();
    let at_end = largest((&dd(q), &dd(p)), (&end.0, &end.1));
    println!(
        "worst {worst:.1e}, at the end {at_end:.1e}, {} steps",
        run.len() - 1
    );
    assert!(worst < 10.0 * at_end, "{worst:e} {at_end:e}");
}

fn same_bits(a: &Run<f64>, b: &Run<f64>) -> bool {
    let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    a.len() == b.len()
        && bits(a.times()) == bits(b.times())
        && (0..a.len()).all(|i| bits(a.q(i)) == bits(b.q(i)) && bits(a.p(i)) == bits(b.p(i)))
}

#[test]
fn the_steps_do_not_feel_it() {
    let (h, (q, p)) = (henon_heiles(), start::<f64>());
    let adaptive = Equip::stages(6).tolerance(1e-9);
    let plain = adaptive.integrate(&h, &q, &p, 0.0..=20.0).unwrap();
    for options in [
        adaptive.clone().dense(),
        adaptive.clone().output_at(&[0.1, 0.2, 3.0, 20.0]),
        adaptive.clone().output_at(&[0.0, 19.9]).dense(),
    ] {
        let run = options.integrate(&h, &q, &p, 0.0..=20.0).unwrap();
        assert!(same_bits(&plain, &run));
    }
    let fixed = Equip::stages(3).step(0.75);
    let plain = fixed.integrate(&h, &q, &p, 0.0..=20.0).unwrap();
    let run = fixed
        .clone()
        .dense()
        .integrate(&h, &q, &p, 0.0..=20.0)
        .unwrap();
    assert!(same_bits(&plain, &run));
    // At the grid points the trajectory is the run, to the last bit.
    let trajectory = run.trajectory().unwrap();
    for i in 0..run.len() - 1 {
        let (q, p) = trajectory.at(run.times()[i]).unwrap();
        assert_eq!((&q[..], &p[..]), (run.q(i), run.p(i)));
    }
    assert!(trajectory.at(-0.1).is_none() && trajectory.at(20.1).is_none());
    assert!(plain.trajectory().is_none());
}

#[test]
fn halved_steps_have_it_too() {
    // Steps so large that fixed-point iterations do not contract in some.
    let (h, (q, p)) = (henon_heiles(), ([0.0, -0.25], [0.42, 0.0]));
    let plain = Preconditioner::Identity;
    let is_halved = |step: f64| {
        let options = Equip::stages(2).step(step).preconditioner(plain).dense();
        let run = options.integrate(&h, &q, &p, 0.0..=150.0).ok()?;
        (run.certificate().counts.halvings > 0).then_some(run)
    };
    let mut sizes = [2.0, 2.125, 2.25, 2.375, 2.5, 2.75, 3.0].into_iter();
    let run = sizes.find_map(is_halved).unwrap();
    let trajectory = run.trajectory().unwrap();
    // Continuous: the change over 1/1000 is that of the velocity.
    let mut before = trajectory.at(0.0).unwrap();
    for i in 1..150_000 {
        let now = trajectory.at(f64::from(i) / 1000.0).unwrap();
        let moved = largest((&before.0, &before.1), (&now.0, &now.1));
        assert!(moved < 2e-3, "{i}: {moved}");
        before = now;
    }
}

#[test]
fn a_run_without_a_step_is_its_state() {
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let options = Equip::stages(6).tolerance(1e-10).dense();
    let run = options
        .integrate(&pendulum, &[1.0], &[0.5], 2.0..=2.0)
        .unwrap();
    let curve = run.trajectory().unwrap();
    assert_eq!(curve.at(2.0), Some((vec![1.0], vec![0.5])));
    assert_eq!((curve.at(1.9), curve.at(2.1)), (None, None));
    assert_eq!(
        Trajectory::from_numbers(&curve.to_numbers()).as_ref(),
        Some(curve)
    );
}
