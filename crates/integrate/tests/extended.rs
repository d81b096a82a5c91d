//! Transformed time.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Var;
use equip_integrate::{Equip, Extended, Gauss, Invariant, Method};
use equip_scalar::ratio;

fn two_bodies(_: Var, q: &[Var], p: &[Var]) -> Var {
    0.5 * (p[0] * p[0] + p[1] * p[1]) - (q[0] * q[0] + q[1] * q[1]).sqrt().recip()
}

/// dt/dτ = r^{3/2}: about equal steps in angle all around.
fn rate(_: Var, q: &[Var], _: &[Var]) -> Var {
    (q[0] * q[0] + q[1] * q[1]).powf(ratio(3, 4))
}

#[test]
fn transformed_time_takes_fixed_steps_through_the_pericentre() {
    let kepler = equip_scenes::find("kepler").unwrap();
    let kepler = kepler.instance(&[("e", "0.9")]).unwrap();
    let (q0, p0) = kepler.initial::<f64>();
    let transformed = Extended::transformed(2, two_bodies, rate).unwrap();
    let (q, p) = transformed.start(&q0, &p0, 0.0);
    let made = |method: Method| {
        let options = method.step(0.15);
        let energy = Invariant::new("H", transformed.energy().clone());
        let run = options
            .invariant(energy)
            .integrate(transformed.hamiltonian(), &q, &p, 0.0..=750.0)
            .unwrap();
        let (_, q, p) = run.last();
        let time = q[2];
        let (q1, p1) = kepler.exact(time).unwrap();
        let pairs = q[..2].iter().chain(&p[..2]).zip(q1.iter().chain(&p1));
        let error = pairs.fold(0.0f64, |most, (x, y)| most.max((x - y).abs()));
        let steps = run.certificate().counts.steps as f64 * std::f64::consts::TAU / time;
        let drift = run.certificate().invariants[0].max;
        let periods = time / std::f64::consts::TAU;
        let row = format!("| {method} | {periods:.1} | {steps:.1} | {error:.1e} | {drift:.1e} |\n");
        (row, error, drift, steps)
    };
    let (row, equip, drift, steps) = made(Equip::stages(8));
    let (gauss_row, gauss, ..) = made(Gauss::stages(8));
    println!(
        "\n| | revolutions | steps per revolution | error | H |\n|---|---|---|---|---|\n{row}{gauss_row}"
    );
    // Measured 8.7e-14 (Gauss 2.2e-13), H to 2.0e-14, 56 steps per period; headroom 10.
    assert!(drift < 2e-13 && steps < 60.0);
    assert!(equip < 9e-13 && gauss < 1e-11);
}

#[test]
fn a_suggested_step_meets_the_tolerance() {
    let kepler = equip_scenes::find("kepler").unwrap();
    let kepler = kepler.instance(&[("e", "0.6")]).unwrap();
    let (q, p) = kepler.initial::<f64>();
    let h = kepler.hamiltonian();
    let tolerance = Equip::stages(6).tolerance(1e-10);
    let step = tolerance.suggest_step(h, &q, &p, 0.0..=7.0).unwrap();
    let run = Equip::stages(6)
        .step(step)
        .integrate(h, &q, &p, 0.0..=8.0)
        .unwrap();
    let (t, q, _) = run.last();
    let (q1, _) = kepler.exact(t).unwrap();
    let error = (q[0] - q1[0]).abs().max((q[1] - q1[1]).abs());
    println!("step {step:.4}, error {error:.1e}");
    // Measured 1e-10: more steps than with variable ones, none worse than the tolerance.
    assert!(error < 1e-9 && step > 0.05);
}
