//! Words of certificates and errors against what happened: round-off levels that are large compared with the
//! energies, steps that do not resolve the motion, runs that end at a singularity, at infinity, at a bound of
//! the user's.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::{Certificate, Equip, Gauss, IntegrateError, Invariant};

/// A fall into a black hole with a = 0.9, in coordinates that end at its horizon, r = 1.436, at proper time
/// 20.327.
fn kerr() -> (Hamiltonian, [f64; 2], [f64; 2]) {
    let (a, e, l) = (0.9, 0.95, 1.5);
    let h = Hamiltonian::new(2, move |q, p| {
        let (r, theta) = (q[0], q[1]);
        let sin2 = theta.sin() * theta.sin();
        let sigma = r * r + a * a * (1.0 - sin2);
        let delta = r * r - 2.0 * r + a * a;
        let turning = l - a * e * sin2;
        let falling = (r * r + a * a) * e - a * l;
        (delta * p[0] * p[0] + p[1] * p[1] + turning * turning / sin2 - falling * falling / delta)
            / (2.0 * sigma)
    });
    let r = 10.0_f64;
    let delta = r * r - 2.0 * r + a * a;
    let falling = (r * r + a * a) * e - a * l;
    let square = falling * falling / delta - r * r - 0.01 - (l - a * e).powi(2);
    let q = [r, std::f64::consts::FRAC_PI_2];
    (h.unwrap(), q, [-(square / delta).sqrt(), 0.1])
}

fn certificate_of(
    made: Result<equip_integrate::Run<f64>, equip_integrate::RunFailure<f64>>,
) -> Certificate<f64> {
    match made {
        Ok(run) => run.certificate().clone(),
        Err(failure) => {
            println!("{failure}");
            failure.partial.unwrap().certificate().clone()
        }
    }
}

/// Not "kept on every step", and words that say to which floor where that is the reason.
fn is_not_kept(certificate: &Certificate<f64>, what: &str) {
    println!("{what}\n{certificate}\n");
    assert!(!certificate.energy_conserved_on_every_step(), "{what}");
    let text = certificate.to_string();
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    assert!(
        text.starts_with("energy conserved to round-off: NO: "),
        "{what}: {text}"
    );
}

#[test]
fn a_fall_through_a_horizon_does_not_keep_the_energy() {
    let (h, q, p) = kerr();
    let by_tolerance = Equip::stages(8).tolerance(1e-10).max_steps(60_000);
    let mut judged = 0;
    for (name, made) in [
        (
            "0.1",
            Equip::stages(4).step(0.1).integrate(&h, &q, &p, 0.0..=25.0),
        ),
        (
            "0.05",
            Equip::stages(8)
                .step(0.05)
                .integrate(&h, &q, &p, 0.0..=25.0),
        ),
        (
            "by tolerance",
            by_tolerance.integrate(&h, &q, &p, 0.0..=25.0),
        ),
    ] {
        let certificate = certificate_of(made);
        println!("{name}\n{certificate}");
        // Up to the horizon H is −1/2 beside terms of its own size.
        if certificate.energy.as_ref().unwrap().max > 1e-3 {
            is_not_kept(&certificate, name);
            judged += 1;
        }
    }
    assert!(judged > 0);
}

#[test]
fn angles_beyond_all_digits_keep_nothing() {
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    for options in [Equip::stages(4).step(0.1), Equip::stages(8).step(0.05)] {
        let run = options.integrate(&pendulum, &[1e16], &[1.0], 0.0..=10.0);
        is_not_kept(&certificate_of(run), "pendulum at 1e16");
    }
    // The same pendulum near 0 is kept, also where H vanishes and at rest.
    for start in [1.0, std::f64::consts::FRAC_PI_2, 0.0] {
        let run = Equip::stages(4)
            .step(0.1)
            .integrate(&pendulum, &[start], &[0.0], 0.0..=10.0)
            .unwrap();
        assert!(
            run.certificate().energy_conserved_on_every_step(),
            "{start}"
        );
    }
}

#[test]
fn an_overflow_keeps_nothing() {
    let h = Hamiltonian::new(1, |q, p| 1e160 * q[0] + p[0] * p[0]).unwrap();
    for method in [Equip::stages(4), Gauss::stages(4)] {
        let made = method.step(0.01).integrate(&h, &[0.0], &[0.0], 0.0..=1.0);
        let certificate = certificate_of(made);
        assert!(
            !certificate.energy_conserved_on_every_step(),
            "{certificate}"
        );
    }
}

/// A quadratic energy, which nothing solves for, is judged by its defect: an oscillator about q = 1e9 whose
/// potential is written out loses 1e-16 of q², beside H = 1/2.
#[test]
fn a_quadratic_energy_is_judged_by_its_defect() {
    let centre = 1e9;
    let kept = |h: &Hamiltonian| {
        let options = Equip::stages(4).step(0.1);
        let run = options.integrate(h, &[centre], &[1.0], 0.0..=10.0).unwrap();
        println!("{}", run.certificate());
        let round_off = run.certificate().energy_round_off.unwrap();
        let defect = run.certificate().energy.as_ref().unwrap().max;
        assert!((round_off.round_off - defect).abs() < f64::MIN_POSITIVE);
        run.certificate().energy_conserved_on_every_step()
    };
    let written_out = Hamiltonian::new(1, move |q, p| {
        0.5 * (p[0] * p[0] + q[0] * q[0]) - centre * q[0] + 0.5 * centre * centre
    });
    assert!(!kept(&written_out.unwrap()));
    // Positions are known to 1e-7 of the amplitude, and so is H.
    let plain = Hamiltonian::new(1, move |q, p| {
        0.5 * (p[0] * p[0] + (q[0] - centre) * (q[0] - centre))
    });
    assert!(kept(&plain.unwrap()));
}

/// A12: steps over many turns of a gyration.
#[test]
fn steps_over_a_gyration_are_named() {
    let epsilon = 0.01;
    let h = Hamiltonian::new(2, move |q, p| {
        let across = (1.0 + q[0] * q[0]) * q[1] * q[1] + p[1] * p[1];
        0.5 * p[0] * p[0] + across / (2.0 * epsilon * epsilon)
    })
    .unwrap();
    let (q, p) = ([0.0, epsilon], [1.0, 0.0]);
    let omega = 1.0 / (epsilon * epsilon);
    for method in [Equip::stages(4), Gauss::stages(4)] {
        let coarse = method.step(8.0 / omega);
        let run = coarse.integrate(&h, &q, &p, 0.0..=5.0).unwrap();
        let certificate = run.certificate();
        let phase = certificate.phase_per_step.unwrap();
        println!("{certificate}");
        // ω is √(1 + q1²)/ε², and q1 has gone somewhere.
        assert!(phase.angle > 7.9, "{phase:?}");
        assert!(!certificate.motion_is_resolved());
        let text = certificate.to_string();
        assert!(
            text.contains("not resolved") && text.contains("h ω = "),
            "{text}"
        );
        assert!(
            text.lines().all(|line| line.chars().count() <= 100),
            "{text}"
        );

        // Up to t = 0.1 q1 is below 0.11.
        let start = coarse.integrate(&h, &q, &p, 0.0..=0.1).unwrap();
        let phase = start.certificate().phase_per_step.unwrap();
        assert!((phase.angle - 8.0).abs() < 0.1, "{phase:?}");
        assert!(
            (phase.step - 8.0 / omega).abs() < 1e-12 / omega,
            "{phase:?}"
        );

        let fine = method.step(0.5 / omega);
        let run = fine.integrate(&h, &q, &p, 0.0..=0.1).unwrap();
        assert!(run.certificate().motion_is_resolved());
        assert!(!run.certificate().to_string().contains("not resolved"));
    }
}

/// ẍ = 4 x³ reaches infinity in finite time, with steps of any kind.
#[test]
fn an_escape_is_one_with_steps_of_any_kind() {
    for power in [3, 4, 6] {
        let name = format!("q^{power}");
        let h = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].powi(power)).unwrap();
        for s in [3, 6, 10] {
            let fixed = Equip::stages(s).step(0.01);
            let fixed = fixed.integrate(&h, &[1.0], &[1.5], 0.0..=10.0).unwrap_err();
            assert!(
                matches!(fixed.error, IntegrateError::Escape { .. }),
                "{name}: {fixed}"
            );
            for tolerance in [1e-6, 1e-9, 1e-12] {
                for method in [Equip::stages(s), Gauss::stages(s)] {
                    for end in [10.0, -10.0] {
                        let options = method.tolerance(tolerance);
                        let p = if end > 0.0 { 1.5 } else { -1.5 };
                        let failure = options.integrate(&h, &[1.0], &[p], 0.0..=end);
                        let failure = failure.unwrap_err();
                        assert!(
                            matches!(failure.error, IntegrateError::Escape { .. }),
                            "{name}, {method}, {tolerance:e}: {failure}"
                        );
                    }
                }
            }
        }
    }
}

/// A singularity is named where force and speed have grown, with by how much; a bound where the user set it.
#[test]
fn singularities_and_bounds_are_named_where_they_are() {
    let fall = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2.0 - q[0].recip()).unwrap();
    let options = Equip::stages(6).tolerance(1e-8).max_steps(2000);
    let failure = options
        .integrate(&fall, &[1.0], &[0.0], 0.0..=2.0)
        .unwrap_err();
    let text = failure.to_string();
    println!("{text}");
    match failure.error {
        IntegrateError::StepBelowMinimum { growth, .. } => {
            assert!(
                growth > 1e8 && text.contains("approaches a singularity"),
                "{text}"
            );
        }
        other => panic!("{other}"),
    }

    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let options = Equip::stages(4)
        .tolerance(3e-11)
        .min_step(0.7)
        .first_step(0.8);
    let failure = options
        .integrate(&pendulum, &[1.0], &[0.0], 0.0..=20.0)
        .unwrap_err();
    let text = failure.to_string();
    println!("{text}");
    assert!(
        matches!(failure.error, IntegrateError::StepBelowMinimum { .. }),
        "{text}"
    );
    assert!(
        text.contains("3e-11") && text.contains("`min_step` is 7e-1"),
        "{text}"
    );
    assert!(
        !text.contains("singularity") && !text.contains("kink"),
        "{text}"
    );
}

/// Every method of the family conserves |m|² of a rigid body, and no α changes it: to preserve it changes no
/// step.
#[test]
fn a_quadratic_casimir_takes_no_parameter() {
    let body = Hamiltonian::of_state(3, |m| {
        let kinetic = 0.5 * m[0].powi(2) + 0.25 * m[1].powi(2) + m[2].powi(2) / 6.0;
        kinetic + 0.1 * m[0].powi(4)
    });
    let cross = |m: &[Var]| vec![(0, 1, -m[2]), (0, 2, m[1]), (1, 2, -m[0])];
    let body = body.and_then(|body| body.with_bracket(cross)).unwrap();
    let casimir = || {
        let squares = Hamiltonian::of_state(3, |m| m[0].powi(2) + m[1].powi(2) + m[2].powi(2));
        Invariant::new("|m|²", squares.unwrap())
    };
    let (q, p) = body.halves(&[0.3, 0.2, 1.0]);
    let [watched, preserved] = [
        Equip::stages(3).step(0.1).invariant(casimir()),
        Equip::stages(3).step(0.1).preserve(casimir()),
    ]
    .map(|by| by.integrate(&body, &q, &p, 0.0..=50.0).unwrap());
    assert_eq!(watched.last(), preserved.last());
    assert_eq!(preserved.certificate().counts.uncorrected(), 0);
    assert!(preserved.certificate().invariants[0].max < 1e-14);
}
