//! Outputs, dense output and events end no run whose steps are computed, and are as right as the steps.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Event, Integrator, Method, Run};
use equip_scalar::ratio;

/// A slow rotor that is pushed by a clock q2 = t.
fn rotor() -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        0.31 * p[0] + p[0] * p[0] / 2 + p[1] - 0.002 * (2 * q[0] - q[1]).cos()
    })
    .unwrap()
}

/// The same with time itself.
fn pushed() -> Hamiltonian {
    Hamiltonian::with_time(1, |t, q, p| {
        0.31 * p[0] + p[0] * p[0] / 2 - 0.002 * (2 * q[0] - t).cos()
    })
    .unwrap()
}

/// Three rotors, coupled weakly, in long steps.
fn rotors() -> Hamiltonian {
    Hamiltonian::new(3, |q, p| {
        let free = p[0] * p[0] / 2 + p[1] * p[1] / 3 + ratio(7, 10) * p[2];
        free - 0.001 * ((q[0] - q[1]).cos() + (3 * q[0] - q[2]).cos())
    })
    .unwrap()
}

/// A rotor that is pushed three times a turn, and held by a tilt.
fn tilted() -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        let free = 0.17 * p[0] + p[0] * p[0] / 2 + p[1];
        free - 0.003 * (3 * q[0] - q[1]).cos() + 0.001 * q[0].sin()
    })
    .unwrap()
}

type Start = (&'static [f64], &'static [f64]);

fn methods(stages: &[usize]) -> impl Iterator<Item = (Method, f64)> {
    let settings = stages.iter();
    settings.flat_map(|&s| [1e-6, 1e-9, 1e-12].map(|tolerance| (Equip::stages(s), tolerance)))
}

/// Largest difference of two states.
fn apart(a: (&[f64], &[f64]), b: (&[f64], &[f64])) -> f64 {
    let pairs = a.0.iter().chain(a.1).zip(b.0.iter().chain(b.1));
    pairs.fold(0.0, |most: f64, (x, y)| most.max((x - y).abs()))
}

fn run(options: &Integrator<f64>, h: &Hamiltonian, (q, p): Start, end: f64) -> Run<f64> {
    let run = options.integrate(h, q, p, 0.0..=end);
    run.unwrap_or_else(|failure| panic!("{failure}"))
}

/// Dense output, output times and an event, each alone, beside a run without, whose steps they have; between
/// the steps beside a run with half the tolerance and other stages.
fn as_right_as_the_steps(
    stages: &[usize],
    (name, h): (&str, &Hamiltonian),
    start: Start,
    end: f64,
) {
    let times: Vec<f64> = (1..150).map(|i| end * f64::from(i) / 150.0).collect();
    let reference = run(&Equip::stages(9).tolerance(1e-13), h, start, end);
    let other = Equip::stages(9).tolerance(1e-13).output_at(&times);
    let right: Vec<_> = run(&other, h, start, end)
        .outputs()
        .map(|(_, q, p)| (q.to_vec(), p.to_vec()))
        .collect();
    for (method, tolerance) in methods(stages) {
        let options = method.tolerance(tolerance);
        let plain = run(&options, h, start, end);
        let (_, q, p) = plain.last();
        let (_, q1, p1) = reference.last();
        let off = apart((q, p), (q1, p1));

        let dense = run(&options.clone().dense(), h, start, end);
        let outputs = run(&options.clone().output_at(&times), h, start, end);
        let event = Event::new("section", |_: f64, q: &[f64], _: &[f64]| q[0].sin());
        let section = run(&options.clone().event(event), h, start, end);
        for with in [&dense, &outputs, &section] {
            assert_eq!(with.len(), plain.len(), "{name}, {method}, {tolerance:e}");
            assert_eq!(with.last(), plain.last(), "{name}, {method}, {tolerance:e}");
        }
        let mut worst = 0.0_f64;
        let trajectory = dense.trajectory().unwrap();
        for ((t, q, p), (q1, p1)) in outputs.outputs().zip(&right) {
            let (q2, p2) = trajectory.at(t).unwrap();
            worst = worst.max(apart((q, p), (q1, p1)));
            worst = worst.max(apart((&q2, &p2), (q1, p1)));
        }
        let coarse = dense.certificate().coarse_outputs;
        println!(
            "{name}, {method}, {tolerance:e}: {} steps, off {off:.1e} at the end, {worst:.1e} \
             between, {} sections, {coarse} coarse",
            plain.len() - 1,
            section.events().len()
        );
        assert_eq!(outputs.outputs().count(), times.len());
        assert!(
            section
                .events()
                .iter()
                .all(|root| root.q[0].sin().abs() < 1e-11 * end)
        );
        // Errors of angles grow along the run, and change sign.
        let most = 30.0 * off.max(tolerance * end.sqrt()) + 1e-12 * end;
        assert!(
            worst < most,
            "{name}, {method}, {tolerance:e}: {worst:e}, {most:e}"
        );
        assert_eq!(coarse, 0, "{name}, {method}, {tolerance:e}");
    }
}

#[test]
fn a_rotor_pushed_by_a_clock() {
    as_right_as_the_steps(
        &[4, 6, 8, 10, 12, 16],
        ("rotor", &rotor()),
        (&[0.7, 0.0], &[0.2, 0.0]),
        900.0,
    );
}

#[test]
fn a_rotor_pushed_in_time() {
    as_right_as_the_steps(&[4, 8, 16], ("pushed", &pushed()), (&[0.7], &[0.2]), 900.0);
}

#[test]
fn three_rotors() {
    let start: Start = (&[0.7, 0.1, 0.0], &[0.2, 0.45, 0.0]);
    as_right_as_the_steps(&[8], ("rotors", &rotors()), start, 600.0);
}

#[test]
fn a_tilted_rotor() {
    let start: Start = (&[0.3, 0.0], &[0.1, 0.0]);
    as_right_as_the_steps(&[6, 10, 12], ("tilted", &tilted()), start, 900.0);
}

/// Sections of the clock at multiples of π, which are known.
#[test]
fn ten_thousand_points_of_a_section() {
    let end = 10_000.5 * std::f64::consts::PI;
    let section = Event::new("clock", |_: f64, q: &[f64], _: &[f64]| q[1].sin());
    for s in [6, 8] {
        let options = Equip::stages(s).tolerance(1e-12).event(section.clone());
        let run = run(&options, &rotor(), (&[0.7, 0.0], &[0.2, 0.0]), end);
        assert_eq!(run.events().len(), 10_000);
        for (i, root) in run.events().iter().enumerate() {
            let expected = (i + 1) as f64 * std::f64::consts::PI;
            assert!(
                (root.time - expected).abs() < 1e-13 * expected + 1e-14,
                "{root:?}"
            );
        }
    }
}
