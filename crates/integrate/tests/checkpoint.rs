//! A run that was stopped and resumed is the run that was not, bit for bit.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{
    Checkpoint, Equip, Event, Gauss, IntegrateError, Integrator, Invariant, NoObserver, Observer,
    Preconditioner, Run, StepView,
};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::Instance;
use std::ops::ControlFlow;

fn scene(name: &str, values: &[(&str, &str)]) -> Instance {
    equip_scenes::find(name).unwrap().instance(values).unwrap()
}

/// Keeps the checkpoint after step number `at`, and ends the run there if told to.
#[derive(Default)]
struct Keep {
    at: u64,
    seen: u64,
    end: bool,
    checkpoint: Option<Checkpoint>,
}

impl<T: Float> Observer<T> for Keep {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        self.seen = view.index;
        ControlFlow::Continue(())
    }

    fn wants_checkpoint(&mut self) -> bool {
        self.seen == self.at
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        self.checkpoint = Some(checkpoint);
        if self.end {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}

fn bits<T: Float>(x: &[T]) -> Vec<[u64; 6]> {
    x.iter().map(|x| x.expansion().map(f64::to_bits)).collect()
}

/// All but the time it took: the end of `whole` is that of `rest`, in states and in certificates.
fn assert_same<T: Float>(whole: &Run<T>, rest: &Run<T>, at: usize) {
    assert_eq!(whole.len(), rest.len() + at);
    for i in 0..rest.len() {
        let j = i + at;
        assert_eq!(
            bits(&[whole.times()[j]]),
            bits(&[rest.times()[i]]),
            "step {j}"
        );
        assert_eq!(bits(whole.q(j)), bits(rest.q(i)), "step {j}");
        assert_eq!(bits(whole.p(j)), bits(rest.p(i)), "step {j}");
        assert_eq!(whole.energy_errors()[j], rest.energy_errors()[i]);
        assert_eq!(whole.outcomes()[j], rest.outcomes()[i]);
    }
    let (mut a, b) = (whole.certificate().clone(), rest.certificate());
    a.seconds = b.seconds;
    assert_eq!(&a, b);
}

fn fixed<T: Float>(scene: &Instance, options: &Integrator<T>, at: u64, end: T) {
    let (q, p) = scene.initial::<T>();
    let (h, zero) = (scene.hamiltonian(), T::int(0));
    let whole = options.integrate(h, &q, &p, zero..=end).unwrap();
    let mut keep = Keep {
        at,
        end: true,
        ..Keep::default()
    };
    let first = options
        .integrate_observed(h, &q, &p, zero..=end, &mut keep)
        .unwrap();
    assert_eq!(first.len() as u64, at + 1);
    let checkpoint = keep.checkpoint.unwrap();
    assert_eq!(checkpoint.index(), at);
    let rest = options
        .integrate_from(h, &checkpoint, end, &mut NoObserver)
        .unwrap();
    assert_same(&whole, &rest, at as usize);
}

fn adaptive<T: Float>(scene: &Instance, options: &Integrator<T>, at: u64, end: T) {
    let (q, p) = scene.initial::<T>();
    let (h, zero) = (scene.hamiltonian(), T::int(0));
    let mut keep = Keep {
        at,
        ..Keep::default()
    };
    // A run is the same whether a checkpoint is made of it or not.
    let whole = options.integrate(h, &q, &p, zero..=end).unwrap();
    let watched = options
        .integrate_observed(h, &q, &p, zero..=end, &mut keep)
        .unwrap();
    assert_same(&whole, &watched, 0);
    let rest = options
        .integrate_from(h, &keep.checkpoint.unwrap(), end, &mut NoObserver)
        .unwrap();
    assert_same(&whole, &rest, at as usize);
}

#[test]
fn fixed_steps() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    fixed(&kepler, &Equip::stages(4).step(0.1), 25, 5.03);
    fixed(&kepler, &Gauss::stages(3).step(0.125), 20, 5.0);
    let step = DoubleDouble::decimal("0.1").unwrap();
    fixed(
        &kepler,
        &Equip::stages(4).step(step),
        7,
        DoubleDouble::exact(2.0),
    );
    // Some steps are halved.
    let chaos = scene("henon-heiles", &[]);
    fixed(&chaos, &Equip::stages(2).step(1.5), 50, 150.0);
    let chain = scene("fput-beta", &[("n", "40")]);
    let plain = Preconditioner::Identity;
    let options = Equip::stages(4).step(3.0).preconditioner(plain);
    for at in [1, 5, 12] {
        fixed(&chain, &options, at, 60.0);
    }
    let (q, p) = chain.initial::<f64>();
    let run = options.integrate(chain.hamiltonian(), &q, &p, 0.0..=60.0);
    assert!(run.unwrap().certificate().counts.halvings > 10);
}

#[test]
fn fixed_steps_with_invariants() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    let mut options = Equip::stages(4).step(0.1);
    for i in kepler.invariants() {
        options = options.invariant(Invariant::new(i.name, i.quantity.clone()));
    }
    fixed(&kepler, &options, 31, 5.0);
}

#[test]
fn simplified_newton_remembers_its_hessian() {
    let ring = scene("dnls", &[("n", "20")]);
    for solver in [Preconditioner::Frozen, Preconditioner::Automatic] {
        for method in [Equip::stages(3), Gauss::stages(3)] {
            for at in [1, 7, 12] {
                fixed(&ring, &method.step(0.1).preconditioner(solver), at, 2.0);
            }
        }
    }
    adaptive(
        &ring,
        &Equip::stages(4)
            .tolerance(1e-8)
            .preconditioner(Preconditioner::Frozen),
        5,
        6.0,
    );
}

#[test]
fn variable_steps() {
    let kepler = scene("kepler", &[("e", "0.9")]);
    for at in [1, 2, 11, 26, 40] {
        adaptive(&kepler, &Equip::stages(8).tolerance(1e-12), at, 15.0);
        adaptive(&kepler, &Gauss::stages(6).tolerance(1e-8), at, 15.0);
    }
    let tolerance = DoubleDouble::decimal("1e-24").unwrap();
    adaptive(
        &kepler,
        &Equip::stages(10).tolerance(tolerance),
        13,
        DoubleDouble::exact(7.0),
    );
}

#[test]
fn what_does_not_fit_is_refused() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    let (q, p) = kepler.initial::<f64>();
    let h = kepler.hamiltonian();
    let options = Equip::stages(4).step(0.1);
    let mut stepper = options.start(h, &q, &p, 0.0).unwrap();
    stepper.advance().unwrap();
    let checkpoint = stepper.checkpoint();
    let what = |error| match error {
        IntegrateError::CheckpointMismatch { what, .. } => what,
        other => panic!("{other}"),
    };
    let refused = Equip::stages(4).step(0.2).resume(h, &checkpoint);
    assert_eq!(what(refused.unwrap_err()), "step");
    let refused = Gauss::stages(4).step(0.1).resume(h, &checkpoint);
    assert_eq!(what(refused.unwrap_err()), "method");
    let refused = Equip::stages(4).tolerance(1e-8).resume(h, &checkpoint);
    assert_eq!(what(refused.unwrap_err()), "steps");
    let refused = options.clone().max_halvings(9).resume(h, &checkpoint);
    assert_eq!(what(refused.unwrap_err()), "max_halvings");
    let refused = Equip::stages(6).step(0.1).resume(h, &checkpoint);
    let text = refused.unwrap_err().to_string();
    assert!(
        text.contains("made with stages 4, this run has 6"),
        "{text}"
    );
    let tenth = DoubleDouble::exact(0.1);
    let precision = Equip::stages(4)
        .step(tenth)
        .resume(h, &checkpoint)
        .unwrap_err();
    assert!(matches!(
        precision,
        IntegrateError::CheckpointMismatch {
            what: "floating-point type",
            ..
        }
    ));
    // H with another parameter, and with another number of degrees of freedom.
    let other = scene("henon-heiles", &[]);
    let error = options
        .resume(other.hamiltonian(), &checkpoint)
        .unwrap_err();
    assert!(matches!(
        error,
        IntegrateError::CheckpointOtherEnergy { .. }
    ));
    let pendulum = scene("pendulum", &[]);
    assert!(options.resume(pendulum.hamiltonian(), &checkpoint).is_err());
    // The shorter last step is not on the grid.
    let mut keep = Keep {
        at: 3,
        ..Keep::default()
    };
    options
        .integrate_observed(h, &q, &p, 0.0..=0.25, &mut keep)
        .unwrap();
    let failure = options
        .integrate_from(h, &keep.checkpoint.unwrap(), 1.0, &mut NoObserver)
        .unwrap_err();
    assert!(matches!(
        failure.error,
        IntegrateError::CheckpointOffGrid { time: 0.25 }
    ));
}

#[test]
fn a_checkpoint_belongs_to_its_functions_and_its_start() {
    let kepler = scene("kepler", &[("e", "0.6")]);
    let (q, p) = kepler.initial::<f64>();
    let area = |power: i32| {
        let function = Hamiltonian::new(2, |q, p| (q[0] * p[1] - q[1] * p[0]).powi(power));
        Invariant::new("area", function.unwrap())
    };
    let options = |power| Equip::stages(4).step(0.1).invariant(area(power));
    let energy = |bend: f64, at: f64| {
        Hamiltonian::new(2, |q, p| {
            let r = (q[0].powi(2) + q[1].powi(2)).sqrt();
            0.5 * (p[0].powi(2) + p[1].powi(2)) - r.recip() + bend * (q[0] - at).powi(4)
        })
        .unwrap()
    };
    let h = energy(0.0, 0.0);
    let mut run = options(1).start(&h, &q, &p, 0.0).unwrap();
    run.advance().unwrap();
    let checkpoint = run.checkpoint();
    assert!(options(1).resume(&h, &checkpoint).is_ok());
    // At the state of the checkpoint it has the same value, gradient and Hessian.
    let other = energy(1e-3, run.view().q[0]);
    let refused = options(1).resume(&other, &checkpoint).unwrap_err();
    assert!(matches!(
        refused,
        IntegrateError::CheckpointOtherEnergy { .. }
    ));
    // The name is the same, and so is the value at the start up to its third power.
    let refused = options(3).resume(&h, &checkpoint).unwrap_err();
    assert!(
        matches!(
            refused,
            IntegrateError::CheckpointMismatch {
                what: "an invariant",
                ..
            }
        ),
        "{refused}"
    );
    // Where the run has been they are the same, with all derivatives.
    let walled = |stiffness: f64| {
        Hamiltonian::new(2, |q, p| {
            let r = (q[0].powi(2) + q[1].powi(2)).sqrt();
            let wall = stiffness * (r - 40.0).max(0.0).powi(2);
            0.5 * (p[0].powi(2) + p[1].powi(2)) - r.recip() + wall
        })
        .unwrap()
    };
    let mut run = options(1).start(&walled(3.0), &q, &p, 0.0).unwrap();
    run.advance().unwrap();
    let behind_a_wall = run.checkpoint();
    assert!(options(1).resume(&walled(3.0), &behind_a_wall).is_ok());
    let refused = options(1).resume(&walled(2.0), &behind_a_wall).unwrap_err();
    assert!(matches!(
        refused,
        IntegrateError::CheckpointOtherEnergy { .. }
    ));
    assert_eq!(checkpoint.check_start(&q, &p, 0.0), Ok(()));
    // Numbers of more digits are named before a start that differs by their rounding.
    let wide = |x: &[f64]| {
        x.iter()
            .map(|&x| DoubleDouble::exact(x))
            .collect::<Vec<_>>()
    };
    let refused = checkpoint
        .check_start(&wide(&q), &wide(&p), DoubleDouble::int(0))
        .unwrap_err();
    assert!(
        refused.to_string().contains("floating-point type f64"),
        "{refused}"
    );
    let (other_q, _) = scene("kepler", &[("e", "0.7")]).initial::<f64>();
    for (q, t0, what) in [(&other_q, 0.0, "start state"), (&q, 1.0, "start time")] {
        let refused = checkpoint.check_start(q, &p, t0).unwrap_err();
        let IntegrateError::CheckpointMismatch { what: found, .. } = refused else {
            panic!("{refused}");
        };
        assert_eq!(found, what);
    }
}

/// H(t, q, p) need not be there for the state of one time at another.
#[test]
fn a_run_resumes_where_h_is_not_at_its_start_time() {
    // ln of what is positive along the run, and not at the first time with the last state.
    let h = Hamiltonian::with_time(1, |t, q, p| {
        0.5 * p[0] * p[0] + 1e-3 * (1.0 + t - q[0]).ln()
    });
    let h = h.unwrap();
    let options = Equip::stages(4).step(0.125);
    let mut run = options.start(&h, &[0.0], &[0.9], 0.0).unwrap();
    for _ in 0..16 {
        run.advance().unwrap();
    }
    assert!(run.view().q[0] > 1.5);
    let mut again = options.resume(&h, &run.checkpoint()).unwrap();
    assert_eq!(run.advance().unwrap().q, again.advance().unwrap().q);
}

/// Variable steps are limited after a change of the state by the time since the change before.
#[test]
fn a_run_resumes_between_changes_of_its_state() {
    let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos()).unwrap();
    let moves = Event::new("middle", |_, q: &[f64], _: &[f64]| q[0] - 0.1);
    let moves = moves.rising().then(|_, q, _| {
        q[0] += 0.05;
        ControlFlow::Continue(())
    });
    let options = Equip::stages(8).tolerance(1e-8).event(moves);
    let (start, end) = (([1.2], [0.3]), 25.0);
    let whole = options
        .integrate(&pendulum, &start.0, &start.1, 0.0..=end)
        .unwrap();
    assert!(whole.certificate().state_changes > 2);
    for at in 1..whole.len() as u64 - 4 {
        let mut keep = Keep {
            at,
            ..Keep::default()
        };
        options
            .integrate_observed(&pendulum, &start.0, &start.1, 0.0..=end, &mut keep)
            .unwrap();
        let checkpoint = keep.checkpoint.unwrap();
        let rest = options.integrate_from(&pendulum, &checkpoint, end, &mut NoObserver);
        assert_same(&whole, &rest.unwrap(), at as usize);
    }
}
