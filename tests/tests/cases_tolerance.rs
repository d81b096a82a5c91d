//! Runs by tolerance on inputs from outside: light bodies, components of different units, kinks. Right values
//! by others: Taylor's method in quadruple precision (heyoka), closed forms, DOP853 (SciPy) stopped at every
//! kink with tolerances of 3e-14.
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
    let steps = |options: equip_integrate::Adaptive<f64>| {
        let run = options.integrate(&energy, &q, &p, 0.0..=50.0).unwrap();
        run.certificate().counts.steps
    };
    let options = Gauss::stages(6).tolerance(1e-8);
    let fine = steps(options.clone());
    let coarse = steps(options.atol(&[1e-6], &[1e-4]));
    println!("{fine} and {coarse} steps");
    assert!(coarse * 4 < fine);
}

/// An energy with kinks, a start, the time of the end, the state there, and the errors there of DOP853 with
/// `rtol` = `atol` = 1e-6, 1e-9, 1e-12.
struct Kinked {
    name: &'static str,
    energy: Hamiltonian,
    start: Vec<f64>,
    time: f64,
    right: Vec<f64>,
    others: [f64; 3],
}

/// Jumps of the force, of its first derivative, of its second one.
fn kinked() -> Vec<Kinked> {
    let cut = Hamiltonian::new(2, |q, p| {
        let square = q[0] * q[0] + q[1] * q[1];
        let r = square.sqrt();
        let sixth = r.min(r * 0.0 + 2.5).powi(-6);
        0.5 * (p[0] * p[0] + p[1] * p[1]) + 4.0 * (sixth * sixth - sixth) + 0.05 * square
    });
    let stiffer = Hamiltonian::new(1, |q, p| {
        0.5 * p[0] * p[0] + 0.5 * q[0] * q[0] + 0.3 * q[0] * q[0].abs()
    });
    let cubic = Hamiltonian::new(1, |q, p| {
        0.5 * p[0] * p[0] + 0.5 * q[0] * q[0] + q[0].abs().powi(3) / 6.0
    });
    let bar = Hamiltonian::new(2, |q, p| {
        let square = q[0] * q[0] + q[1] * q[1];
        let x = square.sqrt() / 0.8;
        let one = x * 0.0 + 1.0;
        let r = x.min(one).powi(3) - x.max(one).powi(-3) - 1.0;
        let turning = 1.85 * (q[0] * p[1] - q[1] * p[0]);
        let kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1]);
        let across = q[0] * q[0] - q[1] * q[1];
        kinetic - turning + 0.5 * square.ln() + 0.01 * r * across / square
    });
    let of =
        |name, energy: Result<Hamiltonian, _>, start: &[f64], time, right: &[f64], others| Kinked {
            name,
            energy: energy.unwrap(),
            start: start.to_vec(),
            time,
            right: right.to_vec(),
            others,
        };
    vec![
        of(
            "Lennard-Jones, cut off",
            cut,
            &[1.5, 0.0, 1.2, 0.4],
            30.0,
            &[
                -2.0335884072725,
                -0.5792513801771,
                0.9079690324607,
                -0.0364172437864,
            ],
            [6.5e-4, 1.2e-7, 2.8e-10],
        ),
        // Half swings of two harmonic oscillators.
        of(
            "stiffer one way",
            stiffer,
            &[1.0, 0.0],
            50.0,
            &[-1.093_617_794_953_142_5, 1.059_056_205_979_989_8],
            [2.4e-5, 1.2e-7, 2.6e-11],
        ),
        // Quarters of a swing by Taylor's method with 30 digits (mpmath).
        of(
            "cubic",
            cubic,
            &[1.0, 0.0],
            50.0,
            &[-0.998_521_960_113_204_5, -0.066_556_378_604_024_14],
            [5e-5, 7e-8, 3e-10],
        ),
        of(
            "rotating bar",
            bar,
            &[1.0, 0.1, 1.2, 0.6],
            50.0,
            &[
                -0.920_852_704_578,
                0.293_186_281_594,
                -1.369_519_193_977,
                -0.086_818_961_245,
            ],
            [7.9e-3, 2.0e-6, 8.5e-9],
        ),
    ]
}

/// No step is given up at a kink, and the error stays within a factor 100 of that of DOP853, Gauss's within
/// 300 (measured 220, of a force that bends, with 8 stages and 1e-6).
#[test]
fn kinks_are_passed_as_well_as_by_others() {
    let mut misses = Misses::default();
    for case in kinked() {
        for s in [4, 8] {
            for (tolerance, other) in [1e-6, 1e-9, 1e-12].into_iter().zip(case.others) {
                for (method, factor) in [(Equip::stages(s), 100.0), (Gauss::stages(s), 300.0)] {
                    let start = (case.start.as_slice(), case.time);
                    let (y, _) = end(&case.energy, method, start, tolerance);
                    let what = format!("{}, {method}, tolerance {tolerance:e}", case.name);
                    misses.most(&what, apart(&y, &case.right), factor * other);
                }
            }
        }
    }
    misses.end();
}

/// A ball on a wedge: the force jumps where it is fastest. The right state is that of parabolas.
#[test]
fn jumps_of_the_force_end_no_run() {
    let energy = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + q[0].abs()).unwrap();
    let (q, p, time): (f64, f64, f64) = (1.0, 0.3, 50.0);
    let speed: f64 = (p * p + 2.0 * q).sqrt();
    // From the top of one side down and up the other takes twice the speed.
    let since = (time - (p + speed)) % (4.0 * speed);
    let (side, t) = if since < 2.0 * speed {
        (-1.0, since)
    } else {
        (1.0, since - 2.0 * speed)
    };
    let right = [side * (speed * t - 0.5 * t * t), side * (speed - t)];
    let mut misses = Misses::default();
    for s in [4, 8, 12] {
        for tolerance in [1e-6, 1e-9, 1e-12] {
            for method in [Equip::stages(s), Gauss::stages(s)] {
                let (y, _) = end(&energy, method, (&[q, p], time), tolerance);
                let what = format!("{method}, tolerance {tolerance:e}, error in tolerances");
                misses.most(&what, apart(&y, &right) / tolerance, 3000.0);
            }
        }
    }
    misses.end();
}
