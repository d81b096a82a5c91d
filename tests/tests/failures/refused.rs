//! What is refused before a step is made: options, intervals, starts.

use super::{kepler_failure, kepler_failure_until, says};
use equip_autodiff::Hamiltonian;
use equip_integrate::{
    Alphas, Equip, Gauss, IntegrateError, Invariant, MAX_STAGES, Method, Record,
};
use equip_scalar::{DoubleDouble, Float, ratio};
use equip_tests::{harmonic, kepler};

#[test]
fn stages_out_of_range() {
    let methods = [
        (Equip::stages(0), 2),
        (Equip::stages(1), 2),
        (Equip::stages(1).alphas(Alphas::Last), 2),
        (Equip::stages(MAX_STAGES + 1), 2),
        (Method::fixed_alpha(1, 0.1), 2),
        (Gauss::stages(0), 1),
        (Gauss::stages(MAX_STAGES + 1), 1),
        (Gauss::stages(usize::MAX), 1),
    ];
    for (method, fewest) in methods {
        let (error, text) = kepler_failure(&method.step(0.1));
        let stages = method.stage_count();
        let max = MAX_STAGES;
        assert_eq!(
            error,
            IntegrateError::StagesOutOfRange {
                stages,
                min: fewest,
                max
            }
        );
        says(
            &text,
            &[
                "accepts",
                &format!("{fewest} to {max}"),
                "change the argument of `stages`",
            ],
        );
    }
}

fn steps_that_are_none<T: Float>() {
    for step in [T::int(0), T::INFINITY, -T::INFINITY, T::NAN] {
        let (error, text) = kepler_failure(&Equip::stages(3).step(step));
        assert!(
            matches!(error, IntegrateError::StepOutOfRange { .. }),
            "{error:?}"
        );
        says(
            &text,
            &["must be finite and not zero", "a negative step goes back"],
        );
        let (h, start) = kepler::<T>(6);
        let error = Equip::stages(3)
            .step(step)
            .start(&h, &start.q, &start.p, T::int(0));
        assert!(matches!(error, Err(IntegrateError::StepOutOfRange { .. })));
    }
}

#[test]
fn a_step_that_is_none() {
    steps_that_are_none::<f64>();
    steps_that_are_none::<DoubleDouble>();
}

#[test]
fn a_step_that_time_cannot_resolve() {
    // In f64 only: the second part of a double-double holds a step of any smaller size.
    let (h, start) = kepler::<f64>(6);
    let late = 2.0_f64.powi(53);
    let options = Equip::stages(3).step(0.125);
    let failure = options
        .integrate(&h, &start.q, &start.p, late..=late + 16.0)
        .unwrap_err();
    let expected = IntegrateError::StepBelowTimeResolution {
        step: 0.125,
        time: late,
    };
    assert_eq!(failure.error, expected);
    says(
        &failure.to_string(),
        &["use a larger step, or begin at time 0"],
    );
    let refused = options.start(&h, &start.q, &start.p, late).unwrap_err();
    assert_eq!(
        refused,
        IntegrateError::StepBelowTimeResolution {
            step: 0.125,
            time: late
        }
    );
}

#[test]
fn more_steps_than_can_be_counted() {
    let (error, text) = kepler_failure_until(&Equip::stages(3).step(1e-300), 1e10);
    assert_eq!(
        error,
        IntegrateError::TooManySteps {
            steps: f64::INFINITY
        }
    );
    says(&text, &["use a larger step or a shorter interval"]);
    let (error, _) = kepler_failure_until(&Equip::stages(3).step(1e-8), 1e9);
    assert!(
        matches!(error, IntegrateError::TooManySteps { steps } if (steps / 1e17 - 1.0).abs() < 1e-9)
    );
}

fn intervals_that_are_none<T: Float>() {
    for end in [T::INFINITY, -T::INFINITY, T::NAN] {
        let options = Equip::stages(3).step(T::ratio(1, 10));
        let (error, text) = kepler_failure_until(&options, end);
        assert!(
            matches!(error, IntegrateError::Interval { .. }),
            "{error:?}"
        );
        says(
            &text,
            &["must be finite", "two finite times, in either order"],
        );
    }
}

#[test]
fn an_interval_that_is_not_finite() {
    intervals_that_are_none::<f64>();
    intervals_that_are_none::<DoubleDouble>();
}

#[test]
fn an_empty_interval_is_a_run_of_no_steps() {
    let (h, start) = kepler::<f64>(6);
    let run = Equip::stages(3)
        .step(0.1)
        .integrate(&h, &start.q, &start.p, 3.0..=3.0)
        .unwrap();
    assert_eq!((run.len(), run.times()), (1, &[3.0][..]));
    assert_eq!(run.certificate().counts.steps, 0);
}

#[test]
fn vectors_of_the_wrong_length() {
    let (h, _) = kepler::<f64>(6);
    let options = Equip::stages(3).step(0.1);
    for (q, p, what, found) in [
        (&[1.0][..], &[0.0, 1.0][..], "q0", 1),
        (&[1.0, 0.0, 0.0], &[0.0, 1.0], "q0", 3),
        (&[1.0, 0.0], &[], "p0", 0),
    ] {
        let error = options.start(&h, q, p, 0.0).unwrap_err();
        assert_eq!(
            error,
            IntegrateError::WrongLength {
                what,
                expected: 2,
                found
            }
        );
        says(
            &error.to_string(),
            &[what, &format!("length {found}"), "needs 2"],
        );
    }
    let (other, _) = harmonic::<f64>(&[1.0.into()]);
    let options = options.invariant(Invariant::new("of another scene", other));
    let error = options
        .start(&h, &[1.0, 0.0], &[0.0, 1.0], 0.0)
        .unwrap_err();
    assert_eq!(
        error,
        IntegrateError::WrongLength {
            what: "an invariant",
            expected: 2,
            found: 1
        }
    );
}

#[test]
fn an_initial_value_that_is_not_finite() {
    let (h, _) = kepler::<f64>(6);
    let options = Equip::stages(3).step(0.1);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = options
            .start(&h, &[1.0, bad], &[0.0, 1.0], 0.0)
            .unwrap_err();
        assert!(matches!(
            error,
            IntegrateError::InitialNotFinite {
                what: "q0",
                index: 1,
                ..
            }
        ));
        says(&error.to_string(), &["q0[1]", "must be finite"]);
        let error = options
            .start(&h, &[1.0, 0.0], &[bad, 1.0], 0.0)
            .unwrap_err();
        assert!(matches!(
            error,
            IntegrateError::InitialNotFinite {
                what: "p0",
                index: 0,
                ..
            }
        ));
    }
}

#[test]
fn an_energy_that_is_not_finite_at_the_start() {
    let (h, _) = kepler::<f64>(6);
    let error = Equip::stages(3)
        .step(0.1)
        .start(&h, &[0.0, 0.0], &[0.0, 1.0], 0.0)
        .unwrap_err();
    assert_eq!(
        error,
        IntegrateError::EnergyNotFinite {
            energy: f64::NEG_INFINITY
        }
    );
    says(
        &error.to_string(),
        &["change the initial state, or check H"],
    );
    // H is finite there and its gradient is not.
    let root = Hamiltonian::new(1, |q, p| p[0] * p[0] + q[0].sqrt()).unwrap();
    let error = Gauss::stages(2)
        .step(0.1)
        .start(&root, &[0.0], &[1.0], 0.0)
        .unwrap_err();
    assert_eq!(error, IntegrateError::EnergyNotFinite { energy: 1.0 });
}

#[test]
fn options_outside_their_range() {
    let base = || Equip::stages(3).step(0.1);
    let cases = [
        (
            base().alpha_bound(0.0),
            "alpha_bound",
            "positive and finite",
        ),
        (
            base().alpha_bound(-1.0),
            "alpha_bound",
            "positive and finite",
        ),
        (
            base().alpha_bound(f64::INFINITY),
            "alpha_bound",
            "positive and finite",
        ),
        (
            base().alpha_bound(f64::NAN),
            "alpha_bound",
            "positive and finite",
        ),
        (base().max_halvings(21), "max_halvings", "at most 20"),
        (base().record(Record::Every(0)), "record", "1 or more"),
        (
            Method::fixed_alpha(3, f64::NAN).step(0.1),
            "fixed_alpha",
            "finite",
        ),
        (
            Method::fixed_alpha(3, f64::INFINITY).step(0.1),
            "fixed_alpha",
            "finite",
        ),
    ];
    for (options, name, remedy) in cases {
        let (error, text) = kepler_failure(&options);
        assert!(
            matches!(error, IntegrateError::Option { option, .. } if option == name),
            "{error:?}"
        );
        says(&text, &[&format!("option `{name}`"), "it must be", remedy]);
    }
}

#[test]
fn output_times_outside_the_interval_or_in_disorder() {
    for (times, bad) in [
        (&[0.5, 0.25][..], 1),
        (&[-0.1], 0),
        (&[0.0, 1.0, 1.5], 2),
        (&[f64::NAN], 0),
    ] {
        let (error, text) = kepler_failure(&Equip::stages(3).step(0.1).output_at(times));
        assert!(
            matches!(error, IntegrateError::OutputTime { index, .. } if index == bad),
            "{error:?}"
        );
        says(
            &text,
            &[
                "must lie between 0 and 1",
                "sorted in the direction of the run",
            ],
        );
    }
}

#[test]
fn more_to_keep_than_alphas_to_keep_it_with() {
    let (h, start) = kepler::<f64>(6);
    let runge_lenz = Hamiltonian::new(2, |q, p| {
        p[1] * (q[0] * p[1] - q[1] * p[0]) - q[0] / q[0].hypot(q[1])
    });
    let runge_lenz = Invariant::new("Laplace-Runge-Lenz x", runge_lenz.unwrap());
    let options = |method: Method| method.step(0.05).preserve(runge_lenz.clone());
    for (method, alphas) in [
        (Equip::stages(2), 1),
        (Equip::stages(6).alphas(Alphas::Last), 1),
        (Gauss::stages(4), 0),
    ] {
        let error = options(method)
            .start(&h, &start.q, &start.p, 0.0)
            .unwrap_err();
        assert!(
            matches!(error, IntegrateError::TooFewAlphas { alphas: found, .. } if found == alphas),
            "{error:?}"
        );
        says(&error.to_string(), &["use at least", "or conserve fewer"]);
    }
    assert!(
        options(Equip::stages(3))
            .start(&h, &start.q, &start.p, 0.0)
            .is_ok()
    );
}

#[test]
fn constants_of_fixed_alpha_are_read_in_the_float_type() {
    let method = Method::fixed_alpha(3, ratio(1, 50));
    assert_eq!((method.order(), method.stage_count()), (4, 3));
    assert_eq!(Method::fixed_alpha(3, 0.0).order(), 6);
}
