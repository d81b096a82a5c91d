//! Energies as users write them, through the solver.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{BuildError, Hamiltonian, Var};
use equip_integrate::{Equip, IntegrateError, Outcome, Record};
use equip_scalar::{DoubleDouble, Float, decimal, ratio};
use equip_tests::{Seeded, distance};

#[test]
fn parameters_are_captured_like_in_any_closure() {
    // A planet of mass m around a sun of given strength; a circle of radius r has frequency sqrt(mu/r^3).
    let (mu, mass) = (39.478_417_604, 3.0e-6);
    let planet = Hamiltonian::new(2, |q, p| {
        (p[0] * p[0] + p[1] * p[1]) / (2.0 * mass) - mass * mu / q[0].hypot(q[1])
    })
    .unwrap();
    let r = 5.2_f64;
    let omega = (mu / r.powi(3)).sqrt();
    let quarter = 0.5 * std::f64::consts::PI / omega;
    let run = Equip::stages(6)
        .step(0.25)
        .integrate(&planet, &[r, 0.0], &[0.0, mass * omega * r], 0.0..=quarter)
        .unwrap();
    let (t, q, p) = run.last();
    println!("{q:?} {p:?} {:e}", mass * omega * r);
    assert_eq!(t, quarter);
    // Measured 2.1e-15 and 1.2e-20 (relative to the momentum 7.9e-6: 1.5e-15); headroom 10.
    assert!(distance(q, &[0.0, r]) < 2e-14, "{q:?}");
    assert!(distance(p, &[-mass * omega * r, 0.0]) < 1e-19, "{p:?}");
}

/// N particles on a ring of springs −cos, each feeling its neighbour: the loop a user writes.
fn ring_of_rotors(n: usize) -> Hamiltonian {
    Hamiltonian::new(n, |q, p| {
        let mut h = Var::from(0.0);
        for i in 0..n {
            h += 0.5 * p[i].powi(2);
            h += 1.0 - (q[(i + 1) % n] - q[i]).cos();
        }
        h
    })
    .unwrap()
}

#[test]
fn a_loop_over_particles() {
    let n = 5;
    let mut random = Seeded::new(2024);
    let q: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
    let p: Vec<f64> = (0..n).map(|_| random.between(-1.0, 1.0)).collect();
    let rotors = ring_of_rotors(n);
    let end = |stages, h: f64| {
        let run = Equip::stages(stages)
            .step(h)
            .integrate(&rotors, &q, &p, 0.0..=10.0)
            .unwrap();
        assert!(run.certificate().energy_conserved_on_every_step());
        let (_, q, p) = run.last();
        [q, p].concat()
    };
    // Two orders and two steps agree: measured 1.9e-14; headroom 5.
    assert!(distance(&end(5, 0.1), &end(8, 0.25)) < 1e-13);
    let momentum = |p: &[f64]| p.iter().sum::<f64>();
    assert!((momentum(&end(5, 0.1)[n..]) - momentum(&p)).abs() < 1e-14);
}

/// A particle in a Morse-like well over a corrugated floor, with a power law wall: sin, exp and powf in one
/// H.
fn corrugated() -> Hamiltonian {
    let a = decimal("1.3").unwrap();
    Hamiltonian::new(1, |q, p| {
        let well = (1.0 - (-(a * q[0])).exp()).powi(2);
        0.5 * p[0] * p[0] + well + ratio(1, 10) * (3.0 * q[0]).sin() + (q[0] + 2.0).powf(-1.5)
    })
    .unwrap()
}

fn corrugated_end<T: Float>(stages: usize, n: i64) -> (Vec<T>, T) {
    let run = Equip::stages(stages)
        .step(T::ratio(10, n))
        .record(Record::Ends)
        .integrate(
            &corrugated(),
            &[T::int(0)],
            &[T::int(1)],
            T::int(0)..=T::int(10),
        )
        .unwrap();
    let (_, q, p) = run.last();
    (
        [q, p].concat(),
        run.certificate().energy.as_ref().unwrap().max,
    )
}

#[test]
fn sin_exp_and_powf() {
    let (f64_end, f64_defect) = corrugated_end::<f64>(6, 200);
    let (end, defect) = corrugated_end::<DoubleDouble>(8, 400);
    let (other, _) = corrugated_end::<DoubleDouble>(10, 300);
    let here: Vec<f64> = end.iter().map(|x| x.to_f64()).collect();
    println!(
        "f64: {:.1e}, energy {f64_defect:.1e}; dd: {:.1e}, energy {defect:.1e}",
        distance(&f64_end, &here),
        distance(&end, &other)
    );
    assert!(distance(&f64_end, &here) < 2e-14);
    assert!(f64_defect < 1e-15);
    assert!(distance(&end, &other).to_f64() < 1e-25);
    assert!(defect.to_f64() < 1e-30);
}

#[test]
fn a_branch_on_the_state_is_refused_with_its_line() {
    let line = line!() + 2;
    let refused = Hamiltonian::new(1, |q, p| {
        let stiffness = if q[0] > 0.0 { 2.0 } else { 1.0 };
        0.5 * (p[0] * p[0] + stiffness * q[0] * q[0])
    });
    match refused {
        Err(error @ BuildError::Branch { location }) => {
            assert!(location.file().ends_with("stories.rs"), "{location}");
            assert_eq!(location.line(), line);
            let text = error.to_string();
            assert!(
                text.contains(&location.to_string()) && text.contains(".max()"),
                "{text}"
            );
        }
        other => panic!("{other:?}"),
    }
    // What it says to write instead works: the same H without a branch.
    let piecewise = Hamiltonian::new(1, |q, p| {
        0.5 * (p[0] * p[0] + q[0] * q[0] + q[0].max(0.0).powi(2))
    })
    .unwrap();
    let run = Equip::stages(3)
        .step(0.05)
        .integrate(&piecewise, &[1.0], &[0.0], 0.0..=1.0)
        .unwrap();
    let (_, q, _) = run.last();
    // On the positive side H = (p^2 + 2 q^2)/2, q = cos(sqrt(2) t); order 6 at h = 0.05. Measured 6e-13;
    // headroom 5.
    assert!(
        (q[0] - 2.0_f64.sqrt().cos()).abs() < 3e-12,
        "{}",
        q[0] - 2.0_f64.sqrt().cos()
    );
}

#[test]
fn a_constant_energy_moves_nothing() {
    let constant = Hamiltonian::new(2, |_, _| Var::from(42.0)).unwrap();
    let run = Equip::stages(3)
        .step(0.5)
        .integrate(&constant, &[1.0, 2.0], &[3.0, 4.0], 0.0..=5.0)
        .unwrap();
    for i in 0..run.len() {
        assert_eq!((run.q(i), run.p(i)), (&[1.0, 2.0][..], &[3.0, 4.0][..]));
    }
    let counts = run.certificate().counts;
    assert_eq!(counts.outcome(Outcome::Quadratic), 10);
    assert_eq!(counts.directions, 0);
}

#[test]
fn one_closure_runs_in_both_float_types() {
    let h = corrugated();
    let coarse = Equip::stages(4)
        .step(0.1)
        .integrate(&h, &[0.5], &[0.0], 0.0..=1.0)
        .unwrap();
    let (t0, t1) = (DoubleDouble::int(0), DoubleDouble::int(1));
    let fine = Equip::stages(8)
        .step(DoubleDouble::ratio(1, 20))
        .integrate(&h, &[DoubleDouble::ratio(1, 2)], &[t0], t0..=t1)
        .unwrap();
    let (_, q, _) = coarse.last();
    let (_, exact, _) = fine.last();
    assert!((q[0] - exact[0].to_f64()).abs() < 1e-9);
}

#[test]
fn wrong_lengths_say_which_and_how_many() {
    let rotors = ring_of_rotors(3);
    let failure = Equip::stages(3)
        .step(0.1)
        .integrate(&rotors, &[0.0; 3], &[0.0; 2], 0.0..=1.0)
        .unwrap_err();
    assert_eq!(
        failure.error,
        IntegrateError::WrongLength {
            what: "p0",
            expected: 3,
            found: 2
        }
    );
    assert!(failure.partial.is_none());
    assert_eq!(
        failure.to_string(),
        "p0 has length 2, but this Hamiltonian needs 3"
    );
}
