//! Runs by tolerance on inputs from outside: light bodies, components of different units. Right values by
//! others: Taylor's method in quadruple precision (heyoka). Kinks are in `kinks.rs`.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Gauss, IntegrateError, Method};
use equip_tests::Misses;

/// (q, p) at the end of a run by tolerance from `start`, with the certificate's number of steps.
fn end(
    energy: &Hamiltonian,
    method: Method,
    (start, time): (&[f64], f64),
    tolerance: f64,
) -> (Vec<f64>, u64) {
    let (q, p) = start.split_at(start.len() / 2);
    let run = method
        .tolerance(tolerance)
        .integrate(energy, q, p, 0.0..=time)
        .unwrap_or_else(|failure| panic!("{method}, tolerance {tolerance:e}: {failure}"));
    let (_, q, p) = run.last();
    ([q, p].concat(), run.certificate().counts.steps)
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// Sun, Jupiter and a comet of mass `mu` that passes the Sun at a fortieth of its aphelion, in a plane.
fn comet(mu: f64) -> (Hamiltonian, Vec<f64>) {
    let m = [1.0, 1e-3, mu];
    let energy = Hamiltonian::new(6, move |q, p| {
        let mut h = p[0] * 0.0;
        for i in 0..3 {
            h += (p[2 * i] * p[2 * i] + p[2 * i + 1] * p[2 * i + 1]) / (2.0 * m[i]);
            for j in 0..i {
                let (x, y) = (q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]);
                h -= m[i] * m[j] / (x * x + y * y).sqrt();
            }
        }
        h
    });
    let (planet, comet) = (1.001_f64.sqrt(), (5.0 * 0.05 / 1.95_f64).sqrt());
    let q = [0.0, 0.0, 1.0, 0.0, -0.39, 0.0];
    let p = [0.0, -1e-3 * planet, 0.0, 1e-3 * planet, 0.0, -mu * comet];
    (energy.unwrap(), [q, p].concat())
}

/// 36 revolutions: the error of SciPy's DOP853 with `rtol` = tolerance and `atol` = tolerance × mass is
/// 27 000 to 46 000 tolerances.
#[test]
fn a_comet_of_any_mass_is_as_good_as_asked() {
    let mut misses = Misses::default();
    for (mu, right, most) in [
        (
            1e-6,
            [-0.185_876_937_689_944_7, 0.061_298_227_997_862_16],
            [100.0, 100.0, 100.0],
        ),
        (
            1e-12,
            [-0.185_852_226_539_116_68, 0.061_305_349_780_892_87],
            [100.0, 100.0, 500.0],
        ),
        // Momenta below ε of the largest are rounding: positions alone are judged.
        (
            1e-20,
            [-0.185_852_226_514_404_05, 0.061_305_349_788_014_2],
            [1e4, 1e4, 1e4],
        ),
    ] {
        let (energy, start) = comet(mu);
        for (tolerance, most) in [1e-6, 1e-9, 1e-12].into_iter().zip(most) {
            let (y, _) = end(&energy, Equip::stages(8), (&start, 20.0), tolerance);
            let what = format!("mass {mu:e}, tolerance {tolerance:e}, error in tolerances");
            misses.most(&what, apart(&y[4..6], &right) / tolerance, most);
        }
    }
    misses.end();
}

/// A body of mass 0 has no velocity: nothing is integrated.
#[test]
fn a_body_of_no_mass_is_refused() {
    let (energy, start) = comet(0.0);
    let (q, p) = start.split_at(6);
    let options = Equip::stages(8).tolerance(1e-9);
    let failure = options.integrate(&energy, q, p, 0.0..=1.0).unwrap_err();
    assert!(
        matches!(failure.error, IntegrateError::EnergyNotFinite { .. }),
        "{failure:?}"
    );
    let text = failure.to_string();
    assert!(
        text.contains("for a test particle use a small mass, for example 1e-12"),
        "{text}"
    );
}

/// An orbit beside an oscillator whose unit of length is `unit`.
fn beside(unit: f64) -> (Hamiltonian, Vec<f64>) {
    let energy = Hamiltonian::new(3, move |q, p| {
        let kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1]);
        let (x, v) = (q[2] / unit, p[2] * unit);
        kinetic - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt() + 0.5 * v * v + 0.25 * x.powi(4)
    });
    let start = vec![0.7, 0.0, unit, 0.0, (1.3_f64 / 0.7).sqrt(), 0.3 / unit];
    (energy.unwrap(), start)
}

/// Units of a component make no difference to the error; steps of near cases vary by a fifth.
#[test]
fn units_of_one_component_do_not_matter() {
    let mut misses = Misses::default();
    for s in [4, 8] {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            let made = |unit: f64| {
                let (energy, start) = beside(unit);
                let (mut y, steps) = end(&energy, Equip::stages(s), (&start, 20.0), tolerance);
                (y[2], y[5]) = (y[2] / unit, y[5] * unit);
                (y, steps)
            };
            let (plain, steps) = made(1.0);
            for unit in [1e-12, 1e-4, 1e6, 1e11] {
                let (y, other) = made(unit);
                let what = format!("s = {s}, tolerance {tolerance:e}, unit {unit:e}");
                misses.most(&what, apart(&y, &plain) / tolerance, 100.0);
                let more = steps.max(other) as f64 / steps.min(other) as f64;
                misses.most(&format!("{what}, steps"), more, 1.25);
            }
        }
    }
    misses.end();
}

/// With `atol` a component may be as far off as that in a step: a fast motion of 1e-7 beside an orbit is
/// passed over with 1e-6, and resolved without.
#[test]
fn motion_below_atol_is_not_resolved() {
    let energy = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - q[0].cos() + 0.5 * 900.0 * q[1] * q[1]
    })
    .unwrap();
    let (q, p) = ([1.0, 1e-7], [0.0, 0.0]);
    let steps = |options: equip_integrate::Integrator<f64>| {
        let run = options.integrate(&energy, &q, &p, 0.0..=50.0).unwrap();
        run.certificate().counts.steps
    };
    let options = Gauss::stages(6).tolerance(1e-8);
    let fine = steps(options.clone());
    let coarse = steps(options.atol(&[1e-6], &[1e-4]));
    println!("{fine} and {coarse} steps");
    assert!(coarse * 4 < fine);
}
