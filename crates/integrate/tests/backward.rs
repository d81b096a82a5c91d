//! Runs back in time: those of −H forward bit for bit, with everything that watches a run.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::{Hamiltonian, Var};
use equip_integrate::{
    Checkpoint, Equip, Event, Gauss, IntegrateError, Integrator, Method, NoObserver, Observer,
    Preconditioner, Run, StepView, Target,
};
use equip_scalar::{DoubleDouble, Float};
use std::ops::ControlFlow;

/// A charged particle in a magnetic field with a quartic well: H(q, −p) ≠ H(q, p). `sign` is that of H; both
/// signs take the same operations.
fn particle(sign: f64) -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        let square = q[0] * q[0] + q[1] * q[1];
        (sign * 0.5) * (p[0] * p[0] + p[1] * p[1])
            + (sign * 0.7) * (q[0] * p[1] - q[1] * p[0])
            + (sign * 0.25) * (square * square)
            + (sign * 0.1) * (q[0] * q[0] * q[1])
    })
    .unwrap()
}

/// Kepler's problem, separable.
fn kepler(sign: f64) -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        let r = (q[0] * q[0] + q[1] * q[1]).sqrt();
        (sign * 0.5) * (p[0] * p[0] + p[1] * p[1]) - (sign * 1.25) / r
    })
    .unwrap()
}

/// A pendulum beside a stiff spring: steps that fixed-point iteration does not solve.
fn stiff(sign: f64) -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        (sign * 0.5) * (p[0] * p[0] + p[1] * p[1]) + (sign * 5e3) * (q[1] * q[1])
            - (sign * 1.5) * (q[0] + 0.1 * q[1]).cos()
    })
    .unwrap()
}

/// A system by its sign, and a start.
type Case = (fn(f64) -> Hamiltonian, [f64; 4]);

const STARTS: [Case; 3] = [
    (particle, [0.8, -0.3, 0.2, 0.6]),
    (kepler, [0.5, 0.1, -0.2, 1.9]),
    (stiff, [1.1, 0.02, 0.3, 1.4]),
];

fn same<T: Float>(what: &str, a: &[T], b: &[T]) {
    assert_eq!(a.len(), b.len(), "{what}");
    for (a, b) in a.iter().zip(b) {
        assert!(a == b, "{what}: {a:?} and {b:?}");
    }
}

/// All that a run has, with times in units of `sign`.
fn everything<T: Float>(run: &Run<T>, sign: i64) -> Vec<Vec<T>> {
    let sign = T::int(sign);
    let mut all = vec![run.times().iter().map(|&t| sign * t).collect()];
    for i in 0..run.len() {
        all.push([run.q(i), run.p(i)].concat());
    }
    for (t, q, p) in run.outputs() {
        all.push([&[sign * t], q, p].concat());
    }
    for event in run.events() {
        let numbers = [T::int(event.event as i64), T::int(event.rising.into())];
        all.push([&numbers[..], &[sign * event.time], &event.q, &event.p].concat());
    }
    if let Some(trajectory) = run.trajectory() {
        let (start, end) = trajectory.interval();
        for k in 0..=40 {
            let t = start + (end - start) * T::ratio(k, 40);
            let (q, p) = trajectory.at(t).unwrap();
            all.push([&[sign * t], &q[..], &p].concat());
        }
        let beyond = T::ratio(1, 100) * (end - start);
        assert!(trajectory.at(end + beyond).is_none());
        assert!(trajectory.at(start - beyond).is_none());
    }
    let certificate = run.certificate();
    let chaos = certificate.chaos.unwrap();
    all.push(vec![chaos.lyapunov, chaos.megno, sign * certificate.step]);
    if let Some(steps) = certificate.variable_steps {
        all.push(vec![steps.smallest, steps.largest]);
    }
    let counts = certificate.counts;
    all.push(
        [counts.steps, counts.gradients, counts.alpha_updates]
            .map(|n| T::int(n as i64))
            .into(),
    );
    all
}

/// H back from 0 to `end` < 0, and −H forward; the stiff system has no σ that resolves its spring.
fn is_the_mirror<T: Float>(name: &str, options: &Integrator<T>, end: T) {
    let count = if name.starts_with('σ') { 2 } else { 3 };
    for (number, (system, start)) in STARTS.iter().take(count).enumerate() {
        let start = start.map(T::exact);
        let (q, p) = start.split_at(2);
        let outputs = [1, 2, 7, 9].map(|k| end * T::ratio(k, 9));
        let watched = |sign: i64| {
            let options = options.clone().dense().chaos();
            let options = options.output_at(&outputs.map(|t| T::int(sign) * t));
            let g = move |t: T, q: &[T], p: &[T]| q[0] * p[1] + T::ratio(sign, 3) * t * q[1];
            options.event(Event::new("some function", g))
        };
        let interval = |end: T| T::int(0)..=end;
        let back = watched(1).integrate(&system(1.0), q, p, interval(end));
        let forward = watched(-1).integrate(&system(-1.0), q, p, interval(-end));
        let [back, forward] = match [back, forward].map(|run| run.map_err(|failure| failure.error))
        {
            [Ok(back), Ok(forward)] => [back, forward],
            [back, forward] => panic!("{name}, {number}: {:?}, {:?}", back.err(), forward.err()),
        };
        assert!(back.last().0 == end && back.len() > 5);
        let (back, forward) = (everything(&back, 1), everything(&forward, -1));
        assert_eq!(back.len(), forward.len());
        for (back, forward) in back.iter().zip(&forward) {
            same(&format!("{name}, system {number}"), back, forward);
        }
    }
}

#[test]
fn a_run_back_in_time_is_that_of_minus_h_forward_bit_for_bit() {
    let (four, end) = (Equip::stages(4), -4.0);
    is_the_mirror("fixed", &four.step(0.03125), end);
    is_the_mirror("fixed, a shorter last step", &four.step(0.03), end);
    is_the_mirror("Gauss", &Gauss::stages(3).step(0.04), end);
    is_the_mirror("tolerance", &four.tolerance(1e-9), end);
    is_the_mirror("fine tolerance", &Equip::stages(8).tolerance(1e-13), end);
    for preconditioner in [
        Preconditioner::Diagonal,
        Preconditioner::Frozen,
        Preconditioner::Full,
    ] {
        let options = four.step(0.05).preconditioner(preconditioner);
        is_the_mirror(&format!("{preconditioner:?}"), &options, -1.0);
    }
}

#[test]
fn the_same_in_double_double() {
    let tolerance = DoubleDouble::decimal("1e-20").unwrap();
    is_the_mirror(
        "tolerance",
        &Equip::stages(8).tolerance(tolerance),
        DoubleDouble::int(-1),
    );
    let step = DoubleDouble::ratio(1, 30);
    is_the_mirror("fixed", &Equip::stages(6).step(step), DoubleDouble::int(-1));
}

#[test]
fn suggested_steps_are_those_of_minus_h() {
    let (q, p) = ([0.8, -0.3], [0.2, 0.6]);
    for target in [
        Target::Phase(0.5),
        Target::Trajectory(1e-8),
        Target::Energy(1e-8),
    ] {
        let step = |h: Hamiltonian, end: f64| {
            let method = Equip::stages(4);
            method.suggest_step(&h, &q, &p, 0.0..=end, target).unwrap()
        };
        assert_eq!(step(particle(1.0), -5.0), step(particle(-1.0), 5.0));
    }
    let adaptive = Equip::stages(4).tolerance(1e-9);
    let step = |h: Hamiltonian, end: f64| adaptive.suggest_step(&h, &q, &p, 0.0..=end).unwrap();
    assert_eq!(step(particle(1.0), -5.0), step(particle(-1.0), 5.0));
}

/// Keeps the checkpoint after a step.
struct Keep(u64, u64, Option<Checkpoint>);

impl<T: Float> Observer<T> for Keep {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        self.0 = view.index;
        ControlFlow::Continue(())
    }

    fn wants_checkpoint(&mut self) -> bool {
        self.0 == self.1
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        self.2 = Some(checkpoint);
        ControlFlow::Continue(())
    }
}

fn goes_on_the_same(options: &Integrator<f64>) {
    let (h, q, p) = (particle(1.0), [0.8, -0.3], [0.2, 0.6]);
    let options = options.clone().chaos();
    let mut keep = Keep(0, 7, None);
    let whole = options.integrate_observed(&h, &q, &p, 1.0..=-4.0, &mut keep);
    let (whole, checkpoint) = (whole.unwrap(), keep.2.unwrap());
    let rest = options.integrate_from(&h, &checkpoint, -4.0, &mut NoObserver);
    let rest = rest.unwrap();
    assert_eq!(whole.last(), rest.last());
    assert_eq!(&whole.times()[7..], rest.times());
    assert_eq!(whole.certificate().counts, rest.certificate().counts);
    assert_eq!(whole.certificate().chaos, rest.certificate().chaos);
    // The way that the run goes is in it: an end on the other side of its start is none.
    let error = options.integrate_from(&h, &checkpoint, 2.0, &mut NoObserver);
    assert!(matches!(
        error.unwrap_err().error,
        IntegrateError::StepsLeadAway { end: 2.0, .. }
    ));
    for end in [f64::NAN, f64::INFINITY] {
        let error = options.integrate_from(&h, &checkpoint, end, &mut NoObserver);
        assert!(matches!(
            error.unwrap_err().error,
            IntegrateError::Interval { .. }
        ));
    }
}

#[test]
fn checkpoints_of_runs_back_in_time_go_on_bit_for_bit() {
    let four = Equip::stages(4);
    goes_on_the_same(&four.step(0.03125));
    goes_on_the_same(&four.tolerance(1e-10));
    // A negative step is the same option.
    let (h, q, p) = (particle(1.0), [0.8, -0.3], [0.2, 0.6]);
    let mut run = four.step(-0.1).start(&h, &q, &p, 0.0).unwrap();
    assert_eq!(run.advance().unwrap().step, -0.1);
    let mut again = four.step(0.1).resume(&h, &run.checkpoint()).unwrap();
    assert_eq!(run.advance().unwrap().q, again.advance().unwrap().q);
    assert_eq!((run.time(), again.time()), (-0.2, -0.2));
}

#[test]
fn a_negative_step_goes_back_and_only_back() {
    let (h, q, p) = (particle(1.0), [0.8, -0.3], [0.2, 0.6]);
    let run = |step: f64, end: f64| Equip::stages(4).step(step).integrate(&h, &q, &p, 0.0..=end);
    let (negative, positive) = (run(-0.125, -3.0).unwrap(), run(0.125, -3.0).unwrap());
    assert_eq!(negative.last(), positive.last());
    assert_eq!(negative.certificate().step, -0.125);
    let error = run(-0.125, 3.0).unwrap_err().error;
    let text = error.to_string();
    assert!(matches!(error, IntegrateError::StepsLeadAway { .. }));
    assert!(text.contains("a step without a sign"), "{text}");
    // Outputs are in the order of travel.
    let options = Equip::stages(4).tolerance(1e-8).output_at(&[-2.0, -1.0]);
    let error = options.integrate(&h, &q, &p, 0.0..=-3.0).unwrap_err().error;
    assert!(matches!(error, IntegrateError::OutputTime { index: 1, .. }));
}

/// Nothing moves but time: H = p, from 0 back to −10, g = cos t + 0.9.
#[test]
fn events_come_in_the_order_of_travel_also_two_in_a_step() {
    let h = Hamiltonian::new(1, |_, p| p[0]).unwrap();
    let g = |t: f64, _: &[f64], _: &[f64]| t.cos() + 0.9;
    // ±arccos(−0.9) less whole turns.
    let first = (-0.9f64).acos();
    let tau = std::f64::consts::TAU;
    let exact = [-first, first - tau, -first - tau, first - 2.0 * tau];
    assert!((exact[3] + 9.875_804_772_565_64).abs() < 1e-14);
    for tolerance in [1e-8, 1e-12] {
        let options = Equip::stages(4).tolerance(tolerance);
        let all = options.clone().event(Event::new("g", g));
        let run = all.integrate(&h, &[0.0], &[1.0], 0.0..=-10.0).unwrap();
        let times: Vec<f64> = run.events().iter().map(|event| event.time).collect();
        println!("{times:?}, {} steps", run.len() - 1);
        assert_eq!(times.len(), 4);
        for (&time, exact) in times.iter().zip(exact) {
            assert!((time - exact).abs() < 4e-15, "{time} {exact}");
        }
        // g falls where the run comes to it first.
        let rising: Vec<bool> = run.events().iter().map(|event| event.rising).collect();
        assert_eq!(rising, [false, true, false, true]);
        let terminal = options.event(Event::new("g", g).rising().terminal());
        let run = terminal.integrate(&h, &[0.0], &[1.0], 0.0..=-10.0).unwrap();
        assert!(run.stopped() && (run.last().0 - exact[1]).abs() < 4e-15);
        assert!((run.last().1[0] - exact[1]).abs() < 1e-14);
    }
    // A run that begins on a root has not crossed it.
    let plain = Equip::stages(4)
        .tolerance(1e-10)
        .event(Event::new("t", |t, _, _| t));
    let run = plain.integrate(&h, &[0.0], &[1.0], 0.0..=-1.0).unwrap();
    assert!(run.events().is_empty());
}

/// H as its user writes it, and −(H): the change of sign, which is exact, adds nothing to what the steps take
/// for round-off.
#[test]
fn minus_h_written_as_a_change_of_sign_is_minus_h() {
    let mut bits = 0x5eed_0051_u64;
    let mut random = |low: f64, high: f64| {
        // xorshift64*, Vigna 2016.
        bits ^= bits >> 12;
        bits ^= bits << 25;
        bits ^= bits >> 27;
        let unit = (bits.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 * (-53_f64).exp2();
        low + (high - low) * unit
    };
    let kepler = |q: &[Var], p: &[Var]| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    };
    let is_same = |energy: &dyn Fn(&[Var], &[Var]) -> Var, start: [f64; 4], method: Method| {
        let (q, p) = start.split_at(2);
        let forward = Hamiltonian::new(2, |q, p| -energy(q, p)).unwrap();
        let back = Hamiltonian::new(2, energy).unwrap();
        for tolerance in [1e-6, 1e-10] {
            let options = method.tolerance(tolerance);
            let [one, other] = [(&back, -8.0), (&forward, 8.0)].map(|(h, end)| {
                let run = options.integrate(h, q, p, 0.0..=end).unwrap();
                [run.last().1, run.last().2].concat()
            });
            same("−(H)", &one, &other);
        }
    };
    for stages in [3, 4, 8] {
        is_same(&kepler, [0.4, 0.0, 0.0, 2.0], Equip::stages(stages));
    }
    for number in 0..40 {
        let c: [f64; 6] = std::array::from_fn(|_| random(0.2, 1.0));
        let start = std::array::from_fn(|_| random(-1.0, 1.0));
        let energy = |q: &[Var], p: &[Var]| {
            let kinetic = (p[0].powi(2) + c[0] * p[1].powi(2)) / 2.0;
            let wells = c[1] * q[0].powi(4) + c[2] * q[1].powi(2) + 0.25 * (q[1] - q[0]).powi(4);
            kinetic + wells + c[3] * q[0] * q[1] - c[4] * (c[5] * q[0]).cos()
        };
        is_same(&energy, start, Equip::stages(3 + number % 4));
    }
}
