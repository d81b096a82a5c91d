//! Gradients written by hand, held against H along runs.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{
    Energy, Evaluate, Hamiltonian, Kinetic, RecordedEvaluator, Structure, System,
};
use equip_integrate::{Equip, Gauss, IntegrateError, Stepper};
use equip_scalar::{Float, InstructionSet, Num, Scalar};

fn pendulum() -> Hamiltonian {
    Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap()
}

/// sin q, with the wrong sign beyond `limit`.
fn wrong_beyond(limit: f64, q: f64) -> f64 {
    if q > limit { -q.sin() } else { q.sin() }
}

/// A wrong sign is found before the first step, whatever makes the steps.
#[test]
fn a_wrong_sign_is_found_at_the_start() {
    let wrong = pendulum().with_gradient(|q, p, dq, dp| (dq[0], dp[0]) = (-q[0].sin(), p[0]));
    let expected = IntegrateError::WrongGradient {
        time: 2.0,
        what: "q",
        index: 0,
        given: -0.5_f64.sin(),
        expected: 0.5_f64.sin(),
    };
    let fixed = Equip::stages(4)
        .step(0.1)
        .start(&wrong, &[0.5], &[0.3], 2.0);
    let error = fixed.map(|_| ()).unwrap_err();
    println!("{error}");
    for part in ["t = 2", "∂H/∂q[0]", "4.794", "check_gradient(false)"] {
        assert!(error.to_string().contains(part), "{part}: {error}");
    }
    assert_eq!(error, expected);
    let variable = Gauss::stages(4).tolerance(1e-8);
    let failure = variable
        .integrate(&wrong, &[0.5], &[0.3], 2.0..=3.0)
        .unwrap_err();
    assert_eq!(failure.error, expected);
    assert!(failure.partial.is_none());
}

/// A momentum's component, and one that is right where the run starts.
#[test]
fn a_gradient_that_is_wrong_elsewhere_is_found_on_the_way() {
    // From q = 0 with the speed 1: q = 0.6 is reached at t = 0.62.
    let wrong =
        pendulum().with_gradient(|q, p, dq, dp| (dq[0], dp[0]) = (wrong_beyond(0.6, q[0]), p[0]));
    let found = |error: &IntegrateError<f64>| match error {
        IntegrateError::WrongGradient {
            time,
            what,
            index,
            given,
            expected,
        } => {
            assert_eq!((*what, *index), ("q", 0));
            assert!(
                (given + expected).abs() < 1e-12 && *expected > 0.5,
                "{error}"
            );
            assert!(*time > 0.6 && *time < 1.3, "{error}");
        }
        other => panic!("{other}"),
    };
    for method in [Equip::stages(4), Gauss::stages(4)] {
        let failure = method
            .step(0.01)
            .integrate(&wrong, &[0.0], &[1.0], 0.0..=2.0);
        let failure = failure.unwrap_err();
        found(&failure.error);
        // The state before the step that was not made.
        let partial = failure.partial.unwrap();
        assert!(partial.last().0 > 0.6 && partial.last().0 < 1.3);
    }
    let failure = Equip::stages(4)
        .tolerance(1e-9)
        .first_step(0.01)
        .max_step(0.01)
        .integrate(&wrong, &[0.0], &[1.0], 0.0..=2.0)
        .unwrap_err();
    found(&failure.error);

    // Taken as it is.
    let unchecked = Gauss::stages(4).step(0.01).check_gradient(false);
    let run = unchecked
        .integrate(&wrong, &[0.0], &[1.0], 0.0..=2.0)
        .unwrap();
    assert_eq!(run.last().0, 2.0);
}

struct ByType;

impl Energy for ByType {
    fn degrees_of_freedom(&self) -> usize {
        1
    }
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        0.5 * p[0] * p[0] - q[0].cos()
    }
    fn gradient<T: Float>(&self, q: &[T], p: &[T], dq: &mut [T], dp: &mut [T]) -> bool {
        dq[0] = q[0].sin();
        // The sign of the speed is lost in flight to the left.
        dp[0] = if q[0] < T::int(0) { -p[0] } else { p[0] };
        true
    }
}

#[test]
fn gradients_of_a_type_are_checked_in_every_float() {
    fn is_found<T: Float>() {
        let wrong = Hamiltonian::from_energy(ByType).unwrap();
        let [step, q, p, start, end] = [0.01, 0.2, -1.0, 0.0, 2.0].map(T::exact);
        let run = Equip::stages(4).step(step);
        let failure = run.integrate(&wrong, &[q], &[p], start..=end).unwrap_err();
        let IntegrateError::WrongGradient { what, index, .. } = failure.error else {
            panic!("{failure}");
        };
        assert_eq!((what, index), ("p", 0));
    }
    is_found::<f64>();
    is_found::<equip_scalar::DoubleDouble>();
}

/// At a kink either side's derivative is right.
#[test]
fn a_start_on_a_kink_is_no_fault() {
    let wedge = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + q[0].abs()).unwrap();
    for at_kink in [-1.0, 0.0, 1.0] {
        let given = wedge.clone().with_gradient(move |q, p, dq, dp| {
            dq[0] = if q[0] == 0.0 { at_kink } else { q[0].signum() };
            dp[0] = p[0];
        });
        let start = Equip::stages(4)
            .step(0.1)
            .start(&given, &[0.0], &[1.0], 0.0);
        assert!(start.is_ok(), "{at_kink}");
    }
}

/// A right gradient is not found wrong, and costs the run nothing that is counted.
#[test]
fn a_right_gradient_is_left_alone() {
    let right = pendulum().with_gradient(|q, p, dq, dp| (dq[0], dp[0]) = (q[0].sin(), p[0]));
    let counts = |check: bool| {
        let options = Equip::stages(4).step(0.1).check_gradient(check);
        let run = options
            .integrate(&right, &[2.0], &[0.0], 0.0..=100.0)
            .unwrap();
        run.certificate().counts
    };
    assert_eq!(counts(true), counts(false));
}

/// A system given by hand, with values, derivatives and all: H of `inner`, and its gradient but for a sign
/// beyond `limit`.
struct ByHand {
    inner: Hamiltonian,
    limit: f64,
}

struct ByHandEvaluator<T: Float> {
    inner: RecordedEvaluator<T>,
    limit: T,
}

impl<T: Float> ByHandEvaluator<T> {
    fn spoil(&self, q: T, slope: &mut T) {
        if q > self.limit {
            *slope = -*slope;
        }
    }
}

impl System for ByHand {
    type Evaluator<T: Float> = ByHandEvaluator<T>;

    fn structure(&self) -> &Structure {
        self.inner.structure()
    }

    fn evaluator<T: Float>(&self) -> ByHandEvaluator<T> {
        ByHandEvaluator {
            inner: self.inner.evaluator(),
            limit: T::exact(self.limit),
        }
    }
}

impl<T: Float> Evaluate<T> for ByHandEvaluator<T> {
    fn value(&mut self, y: &[T]) -> T {
        self.inner.value(y)
    }

    fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T {
        let value = self.inner.gradient(y, gradient);
        self.spoil(y[0], &mut gradient[0]);
        value
    }

    fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        let found = self.inner.gradient_with_bound(y, gradient);
        self.spoil(y[0], &mut gradient[0]);
        found
    }

    fn gradients_by_component(&mut self, y: &[T], out: &mut [T], stride: usize, count: usize) {
        self.inner.gradients_by_component(y, out, stride, count);
        (0..count).for_each(|i| self.spoil(y[i], &mut out[i]));
    }

    fn forces_by_component(&mut self, q: &[T], out: &mut [T], stride: usize, count: usize) {
        self.inner.forces_by_component(q, out, stride, count);
        (0..count).for_each(|i| self.spoil(q[i], &mut out[i]));
    }

    fn kinetic(&mut self) -> Option<Kinetic<T>> {
        self.inner.kinetic()
    }

    fn set_instruction_set(&mut self, set: InstructionSet) {
        self.inner.set_instruction_set(set);
    }

    fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        self.inner.hessian_vector(y, v, product);
    }

    fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        self.inner.hessian(y, entries);
    }
}

#[test]
fn a_system_given_by_hand_is_checked_by_differences() {
    let of = |limit| ByHand {
        inner: Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap(),
        limit,
    };
    let options = Gauss::stages(4).step(0.01);
    let failure = options
        .integrate(&of(0.6), &[0.0], &[1.0], 0.0..=2.0)
        .unwrap_err();
    match failure.error {
        IntegrateError::WrongGradient {
            what,
            index,
            given,
            expected,
            ..
        } => {
            assert_eq!((what, index), ("q", 0));
            assert!((given + expected).abs() < 1e-6, "{given} {expected}");
        }
        other => panic!("{other}"),
    }
    // Right ones are let through, in both floats, at rest and far out.
    for q in [0.0, 1.0, 1e-9, 3e5] {
        let run = options.integrate(&of(f64::INFINITY), &[q], &[1.0], 0.0..=1.0);
        assert!(run.is_ok(), "{q}");
    }
    let wide = equip_scalar::DoubleDouble::exact;
    let options = Gauss::stages(4).step(wide(0.125));
    let run = options.integrate(
        &of(f64::INFINITY),
        &[wide(0.5)],
        &[wide(0.0)],
        wide(0.0)..=wide(1.0),
    );
    assert!(run.is_ok());
}

/// A step of two parts, up to a kink and from there, whose second part fails leaves the largest floor of late
/// as it was: that of the well from which the run came.
#[test]
fn a_step_that_fails_in_its_second_part_forgets_no_floor() {
    let energy = |kink: f64| {
        let h = Hamiltonian::new(1, |q, p| {
            let well = 100.0 / (1.0 + 100.0 * q[0] * q[0]);
            0.5 * p[0] * p[0] - well + (q[0] - kink).max(0.0).powi(2)
        });
        h.unwrap()
    };
    fn after_128_steps<H: System>(h: &H) -> Stepper<f64, H::Evaluator<f64>> {
        let options = Equip::stages(4).step(0.002).max_halvings(0);
        let run = options.start(h, &[0.0], &[201_f64.sqrt()], 0.0);
        let mut run = run.unwrap();
        for _ in 0..128 {
            run.advance().unwrap();
        }
        run
    }
    fn floor_back<E: Evaluate<f64>>(run: &mut Stepper<f64, E>) -> f64 {
        run.turn_back();
        run.advance().unwrap().energy_floor.unwrap()
    }
    let mut smooth = after_128_steps(&energy(9.0));
    let from = smooth.view().q[0];
    let step = smooth.advance().unwrap().q[0] - from;
    let kink = from + 0.5 * step;
    // The third of four stages from the kink on, at 0.5 + 0.67/2, is beside those of the whole step.
    let hole = from + 0.835 * step;
    let holed = energy(kink).with_gradient(move |q, p, dq, dp| {
        let slope = 2e4 * q[0] / (1.0 + 100.0 * q[0] * q[0]).powi(2);
        dq[0] = slope + 2.0 * (q[0] - kink).max(0.0);
        if (q[0] - hole).abs() < 0.01 * step {
            dq[0] = f64::NAN;
        }
        dp[0] = p[0];
    });
    let mut run = after_128_steps(&holed);
    let error = run.advance().unwrap_err();
    let IntegrateError::NotFinite { time, .. } = error else {
        panic!("{error}");
    };
    // It began at the kink.
    assert!((time - 0.257).abs() < 1e-5, "{error}");
    let mut smooth = after_128_steps(&energy(9.0));
    let (floor, of_late) = (floor_back(&mut run), floor_back(&mut smooth));
    println!("{floor:e} {of_late:e}");
    assert!(floor > 0.9 * of_late);
}
