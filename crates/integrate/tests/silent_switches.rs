//! Energies that bend or jump in their derivatives and do not say where, as a type with `if` does.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::Equip;
use std::sync::{Arc, Mutex};

/// The energy computed from outside, without its switches.
fn silent(h: &Hamiltonian) -> Hamiltonian {
    let evaluator = Arc::new(Mutex::new(h.evaluator::<f64>()));
    let for_gradient = Arc::clone(&evaluator);
    let value = move |q: &[f64], p: &[f64]| evaluator.lock().unwrap().value(&[q, p].concat());
    let gradient = move |q: &[f64], p: &[f64], dq: &mut [f64], dp: &mut [f64]| {
        let (y, mut slope) = ([q, p].concat(), vec![0.0; 2 * q.len()]);
        for_gradient
            .lock()
            .unwrap()
            .gradients(&y, &mut slope, y.len());
        dq.copy_from_slice(&slope[..q.len()]);
        dp.copy_from_slice(&slope[q.len()..]);
    };
    Hamiltonian::external(h.degrees_of_freedom(), f64::EPSILON, value, gradient).unwrap()
}

/// The force jumps, in one and in two degrees of freedom, or its first derivative does, or its second one.
fn energies() -> [(&'static str, Hamiltonian); 5] {
    let wedge = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + q[0].abs());
    let one_sided = Hamiltonian::new(1, |q, p| {
        0.5 * (p[0] * p[0] + q[0] * q[0]) + 4.0 * q[0].max(0.0).powi(2)
    });
    let cubic = Hamiltonian::new(1, |q, p| {
        0.5 * (p[0] * p[0] + q[0] * q[0]) + q[0].abs().powi(3) / 6.0
    });
    let across = Hamiltonian::new(2, |q, p| {
        let beyond = (q[0] * 1.3 + 0.7 * q[1] - 0.2).max(0.0);
        let kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1]);
        kinetic + 0.5 * q[0] * q[0] + q[1] * q[1] + 3.0 * beyond.powi(3)
    });
    let two = Hamiltonian::new(2, |q, p| {
        let kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1]);
        kinetic + q[0].abs() + 0.5 * q[1] * q[1] + 0.3 * (q[0] - q[1]).abs()
    });
    [
        ("|q|", wedge.unwrap()),
        ("max(q, 0)²", one_sided.unwrap()),
        ("|q|³", cubic.unwrap()),
        ("max(a·q, 0)³", across.unwrap()),
        ("two |q|", two.unwrap()),
    ]
}

/// Steps go on over kinks that they do not know: no run ends in an error or among tiny steps, and where the
/// energy is off the certificate does not call it kept. Measured: at most 8700 tolerances (|q|³, s = 3,
/// 1e-12) and 2070 steps; 79 of the 80 runs carry.
#[test]
fn kinks_that_are_not_told_are_passed() {
    let (mut most, mut most_steps, mut carrying) = (0.0_f64, 0, 0);
    for (name, energy) in energies() {
        let m = energy.structure().degrees_of_freedom;
        let (q, p) = (&[0.7, -0.4][..m], &[0.3, 0.9][..m]);
        let known = Equip::stages(8).tolerance(1e-12);
        let known = known.integrate(&energy, q, p, 0.0..=30.0).unwrap();
        assert!(known.certificate().discontinuities_crossed > 5, "{name}");
        let right = [known.last().1, known.last().2].concat();
        let silent = silent(&energy);
        for s in [3, 6, 8, 12] {
            for tolerance in [1e-4, 1e-6, 1e-9, 1e-12] {
                let options = Equip::stages(s).tolerance(tolerance);
                let what = format!("{name}, s = {s}, tolerance {tolerance:e}");
                let run = options.integrate(&silent, q, p, 0.0..=30.0);
                let run = run.unwrap_or_else(|failure| panic!("{what}: {failure}"));
                let found = [run.last().1, run.last().2].concat();
                let pairs = found.iter().zip(&right);
                let off = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                let certificate = run.certificate();
                let steps = certificate.counts.steps;
                let uncorrected = certificate.counts.uncorrected();
                let energy = certificate.energy.as_ref().unwrap().max;
                let kept = certificate.energy_conserved_on_every_step();
                println!(
                    "{what}: {:.1e} tolerances, {steps} steps, {uncorrected} uncorrected, energy {energy:.1e}",
                    off / tolerance
                );
                assert_eq!(certificate.discontinuities_crossed, 0, "{what}");
                assert!(off < 3e4 * tolerance, "{what}: {off:e}");
                assert!(steps < 4000, "{what}: {steps} steps");
                assert!(!kept || (uncorrected == 0 && energy < 1e-13), "{what}");
                most = most.max(off / tolerance);
                most_steps = most_steps.max(steps);
                carrying += u32::from(uncorrected > 0);
            }
        }
    }
    println!("{most:.1e} tolerances, {most_steps} steps, {carrying} runs carry");
    assert!(carrying > 40);
}
