//! The first line of a certificate against what happened to the energy: H at the end of the run, evaluated
//! anew in double-double, and the counts of the steps.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Certificate, Equip, Gauss, Integrator, Run};
use equip_scalar::{DoubleDouble, Float};

const FIRST: &str = "energy conserved to round-off: ";

/// What the first line says, which is the same in the field and in the text, and as a boolean.
fn verdict(certificate: &Certificate<f64>) -> String {
    let text = certificate.to_string();
    let first = text.lines().next().unwrap();
    let verdict = first.strip_prefix(FIRST).unwrap().to_owned();
    assert_eq!(certificate.energy_conserved_to_round_off, verdict);
    // Of no step nothing is said, and none has an energy error.
    let is_yes = verdict.starts_with("yes, ") || verdict == "no step was made";
    assert_eq!(
        certificate.energy_conserved_on_every_step(),
        is_yes,
        "{text}"
    );
    assert!(
        text.lines().all(|line| line.chars().count() <= 100),
        "{text}"
    );
    assert!(
        !text.contains("max NaN") && !text.contains("max inf"),
        "{text}"
    );
    verdict
}

/// H at the end less H at the start, each evaluated in double-double at the states in doubles.
fn error_at_end(h: &Hamiltonian, run: &Run<f64>) -> f64 {
    let mut energy = h.evaluator::<DoubleDouble>();
    let mut value = |i: usize| {
        let y = run.q(i).iter().chain(run.p(i));
        let y: Vec<DoubleDouble> = y.map(|&x| DoubleDouble::exact(x)).collect();
        energy.value(&y)
    };
    (value(run.len() - 1) - value(0)).to_f64()
}

/// The run, or what there was of it.
fn made(
    options: &Integrator<f64>,
    h: &Hamiltonian,
    (q, p): (&[f64], &[f64]),
    end: f64,
) -> Run<f64> {
    match options.integrate(h, q, p, 0.0..=end) {
        Ok(run) => run,
        Err(failure) => *failure.partial.unwrap(),
    }
}

#[test]
fn uncorrected_steps_are_counted_on_the_first_line() {
    // A gyration that these steps pass over: no step is corrected.
    let epsilon = 0.01;
    let h = Hamiltonian::new(2, move |q, p| {
        let across = (1.0 + q[0] * q[0]) * q[1] * q[1] + p[1] * p[1];
        0.5 * p[0] * p[0] + across / (2.0 * epsilon * epsilon)
    });
    let (h, start) = (h.unwrap(), (&[0.0, epsilon][..], &[1.0, 0.0][..]));
    let run = made(&Equip::stages(4).step(8e-4), &h, start, 0.04);
    let certificate = run.certificate();
    let (steps, left) = (certificate.counts.steps, certificate.counts.uncorrected());
    assert!(left > 0);
    let largest = certificate.energy.as_ref().unwrap().max;
    let expected = format!("NO: {left} of {steps} steps uncorrected, largest error {largest:.1e}");
    assert_eq!(verdict(certificate), expected);
    // Multiples of the round-off level are those of all steps, of uncorrected ones too.
    assert!(
        certificate.energy_in_round_off_levels.unwrap() > 8.0,
        "{certificate}"
    );

    let run = made(&Gauss::stages(4).step(8e-4), &h, start, 0.04);
    let largest = run.certificate().energy.as_ref().unwrap().max;
    assert_eq!(
        verdict(run.certificate()),
        format!("not requested; largest error {largest:.1e}")
    );
    let unmeasured = Gauss::stages(4).step(8e-4).measure_energy(false);
    let run = made(&unmeasured, &h, start, 0.04);
    assert_eq!(
        verdict(run.certificate()),
        "not requested; its error was not measured"
    );
    // A hundred times as short, they resolve it.
    let run = made(&Equip::stages(4).step(8e-6), &h, start, 0.004);
    assert_eq!(verdict(run.certificate()), "yes, on every step");
}

/// Two bodies that meet head on, but for a core: where they meet all digits of the energy are lost, and what
/// was round-off there is an error afterwards.
#[test]
fn an_error_left_by_a_violent_moment_is_told() {
    for (core, power, tolerance) in [
        (1e-20, 1.0, 1e-10),
        (1e-18, 1.0, 1e-9),
        (1e-16, 1.0, 1e-11),
        (1e-8, 3.0, 1e-10),
    ] {
        let h = Hamiltonian::new(1, move |q, p| {
            0.5 * p[0] * p[0] - (q[0] * q[0] + core).powf(-0.5 * power)
        });
        let (h, end) = (h.unwrap(), if power > 1.0 { 1.0 } else { 3.0 });
        let options = Equip::stages(8).tolerance(tolerance).max_steps(100_000);
        let run = made(&options, &h, (&[1.0], &[0.0]), end);
        let error = error_at_end(&h, &run).abs();
        let verdict = verdict(run.certificate());
        println!("{core:e} {power} {tolerance:e}: off by {error:.1e}, {verdict}");
        let last = run.last();
        if error > 1e-7 {
            assert!(verdict.starts_with("NO: "), "{verdict} at {last:?}");
        }
    }
}

/// A fall from rest to the centre of −1/r³: |H| = 1 and both of its terms without bounds.
#[test]
fn a_fall_to_the_centre_conserves_nothing() {
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].abs().powi(-3)).unwrap();
    let mut judged = 0;
    let mut judge = |run: &Run<f64>| {
        let error = error_at_end(&h, run).abs();
        let verdict = verdict(run.certificate());
        println!("off by {error:.1e}: {verdict}");
        // |H| = 1.
        if !(error <= 1e-5) {
            assert!(verdict.starts_with("NO: "), "{error:e}: {verdict}");
            judged += 1;
        }
    };
    for s in [2, 4, 8] {
        for tolerance in [1e-6, 1e-10] {
            let options = Equip::stages(s).tolerance(tolerance).max_steps(20_000);
            judge(&made(&options, &h, (&[1.0], &[0.0]), 2.0));
        }
        judge(&made(
            &Equip::stages(s).step(0.01),
            &h,
            (&[1.0], &[0.0]),
            2.0,
        ));
    }
    assert!(judged > 0);
}

#[test]
fn an_energy_that_is_not_a_number_is_told() {
    // Beyond q = 1 H overflows, and its gradient is as if nothing had happened.
    let h = Hamiltonian::new(1, |q, p| {
        let large = (1e-300 * q[0] + 1e200).powi(2);
        0.5 * p[0] * p[0] + (1 - q[0]).select(0, large)
    });
    let h = h.unwrap();
    let mut judged = 0;
    for options in [Equip::stages(4), Gauss::stages(4)] {
        let by_tolerance = options.tolerance(1e-9);
        for run in [
            options.step(0.1).integrate(&h, &[0.0], &[1.0], 0.0..=2.0),
            by_tolerance.integrate(&h, &[0.0], &[1.0], 0.0..=2.0),
        ] {
            let Ok(run) = run else {
                continue;
            };
            let verdict = verdict(run.certificate());
            judged += 1;
            assert!(
                verdict.contains("H was infinite or NaN after a step"),
                "{verdict}"
            );
        }
    }
    assert!(judged > 0);
}

#[test]
fn an_energy_that_underflows_is_told() {
    let oscillator = Hamiltonian::new(1, |q, p| 0.5 * (p[0] * p[0] + q[0] * q[0])).unwrap();
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + (1 - q[0].cos())).unwrap();
    let quartic = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + q[0].powi(4)).unwrap();
    // Of 1 − cos q all digits are lost below 1e-8.
    for (h, q, fits) in [
        (&oscillator, 1e-170, 1e-60),
        (&pendulum, 1e-170, 0.1),
        (&quartic, 1e-90, 1e-60),
    ] {
        for options in [Equip::stages(4).step(0.1), Equip::stages(8).step(0.3)] {
            let run = made(&options, h, (&[q], &[0.0]), 2.0);
            let verdict = verdict(run.certificate());
            assert!(verdict.starts_with("NO: H underflows to 0"), "{verdict}");
        }
        // At rest, and with an energy that fits, there is nothing to tell.
        for q in [0.0, fits] {
            let run = made(&Equip::stages(4).step(0.1), h, (&[q], &[0.0]), 2.0);
            assert_eq!(verdict(run.certificate()), "yes, on every step");
        }
    }
    // H = p is 0 where p is, and has nothing to underflow.
    let clock = Hamiltonian::new(1, |_, p| p[0]).unwrap();
    let run = made(&Equip::stages(4).step(0.1), &clock, (&[0.0], &[0.0]), 2.0);
    assert_eq!(verdict(run.certificate()), "yes, on every step");
}

/// No number takes a line of its own.
#[test]
fn numbers_of_any_size_are_short() {
    let free = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + 0.0 * q[0]).unwrap();
    let fixed = Equip::stages(2).step(1e290);
    let run = fixed.integrate(&free, &[0.0], &[1e-300], 1e300..=1.0000001e300);
    verdict(run.unwrap().certificate());
    let hole = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + (1 - q[0]).sqrt()).unwrap();
    let failure = fixed.integrate(&hole, &[0.0], &[1.0], 1e300..=1.001e300);
    let text = failure.unwrap_err().to_string();
    assert!(text.contains("t = 1e300") && text.len() < 400, "{text}");
    for options in [
        Gauss::stages(2).step(1e-300),
        Equip::stages(2).step(f64::NAN),
    ] {
        let failure = options.integrate(&free, &[0.0], &[1.0], 1e300..=2e300);
        let text = failure.unwrap_err().to_string();
        assert!(text.len() < 400, "{text}");
    }
}
