//! Reversible steps: there and back, order, checkpoints, and what they are worth over long times.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_scalar::{DoubleDouble, Float, ratio};
use equip_scenes::Instance;
use equip_solver::{
    Checkpoint, Equip, Gauss, IntegrateError, Method, NoObserver, Observer, Record, StepView,
};
use std::ops::ControlFlow;

fn kepler(e: &str) -> Instance {
    let scene = equip_scenes::find("kepler").unwrap();
    scene.instance(&[("e", e)]).unwrap()
}

/// σ = r^{3/2}.
fn sigma() -> Hamiltonian {
    Hamiltonian::new(2, |q, _| (q[0] * q[0] + q[1] * q[1]).powf(ratio(3, 4))).unwrap()
}

/// Largest distance from the start after `steps` steps forward and as many back.
fn there_and_back<T: Float>(method: Method, epsilon: T, steps: usize) -> f64 {
    let scene = kepler("0.6");
    let (q, p) = scene.initial::<T>();
    let options = method.reversible(epsilon, sigma());
    let mut run = options
        .start(scene.hamiltonian(), &q, &p, T::int(0))
        .unwrap();
    for _ in 0..steps {
        run.advance().unwrap();
    }
    run.turn_back().unwrap();
    for _ in 0..steps {
        run.advance().unwrap();
    }
    let view = run.view();
    let back = view.p.iter().map(|&p| -p);
    let pairs = view.q.iter().copied().chain(back).zip(q.iter().chain(&p));
    pairs.fold(0.0, |most, (x, &y)| most.max((x - y).abs().to_f64()))
}

#[test]
fn there_and_back_is_the_start() {
    // Measured 4.0e-13 and, whether a defect at the floor gets an α hanging on the last bits, 4.4e-11; headroom 10.
    for (method, bound) in [(Gauss::stages(4), 4e-12), (Equip::stages(4), 4e-10)] {
        let distance = there_and_back(method, 0.3, 1000);
        println!("{method}: {distance:.1e}");
        assert!(distance < bound);
    }
    let epsilon = DoubleDouble::decimal("0.3").unwrap();
    let distance = there_and_back(Gauss::stages(4), epsilon, 100);
    println!("double-double: {distance:.1e}");
    assert!(distance < 1e-27);
}

#[test]
fn the_trajectory_is_right_and_the_steps_follow_sigma() {
    let scene = kepler("0.9");
    let (q, p) = scene.initial::<f64>();
    let options = Equip::stages(6).reversible(0.2, sigma());
    let mut sizes = Vec::new();
    let mut observe = |view: &StepView<'_, f64>| {
        let r = view.q[0].hypot(view.q[1]);
        sizes.push(view.step / r.powf(1.5));
        ControlFlow::Continue(())
    };
    let run = options
        .integrate_observed(scene.hamiltonian(), &q, &p, 0.0..=20.0, &mut observe)
        .unwrap();
    let (t, q1, p1) = run.last();
    let (q2, p2) = scene.exact(t).unwrap();
    let pairs = q1.iter().chain(p1).zip(q2.iter().chain(&p2));
    let error = pairs.fold(0.0f64, |most, (x, y)| most.max((x - y).abs()));
    sizes.pop();
    let (low, high) = sizes
        .iter()
        .fold((f64::INFINITY, 0.0f64), |(l, h), &x| (l.min(x), h.max(x)));
    println!(
        "error {error:.1e}, {} steps, h/σ {low:.3} to {high:.3}",
        run.len() - 1
    );
    assert_eq!(t, 20.0);
    // Measured 1.4e-12 with h/σ from 0.171 to 0.235 for ε = 0.2.
    assert!(error < 2e-11 && low > 0.15 && high < 0.26);
}

/// Keeps the checkpoint after step 17.
#[derive(Default)]
struct Keep(u64, Option<Checkpoint>);

impl<T: Float> Observer<T> for Keep {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        self.0 = view.index;
        ControlFlow::Continue(())
    }

    fn wants_checkpoint(&mut self) -> bool {
        self.0 == 17
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        self.1 = Some(checkpoint);
        ControlFlow::Continue(())
    }
}

fn resumed_is_the_same<T: Float>(epsilon: T) {
    let scene = kepler("0.6");
    let (q, p) = scene.initial::<T>();
    let options = Equip::stages(4).reversible(epsilon, sigma());
    let (h, end) = (scene.hamiltonian(), T::int(20));
    let mut keep = Keep::default();
    let whole = options
        .integrate_observed(h, &q, &p, T::int(0)..=end, &mut keep)
        .unwrap();
    let rest = options
        .integrate_from(h, &keep.1.unwrap(), end, &mut NoObserver)
        .unwrap();
    assert_eq!(whole.len(), rest.len() + 17);
    assert_eq!(whole.last(), rest.last());
    assert_eq!(whole.certificate().counts, rest.certificate().counts);
}

#[test]
fn a_resumed_run_is_the_same() {
    resumed_is_the_same(0.3);
    resumed_is_the_same(DoubleDouble::decimal("0.3").unwrap());
}

#[test]
fn a_bad_sigma_is_refused() {
    let scene = kepler("0.6");
    let (q, p) = scene.initial::<f64>();
    let negative = Hamiltonian::new(2, |q, _| -q[0]).unwrap();
    let start = |sigma, epsilon: f64| {
        let options = Equip::stages(4).reversible(epsilon, sigma);
        options.start(scene.hamiltonian(), &q, &p, 0.0).map(|_| ())
    };
    let error = start(negative, 0.1).unwrap_err();
    assert!(matches!(
        error,
        IntegrateError::Option {
            option: "sigma",
            ..
        }
    ));
    let other = Hamiltonian::new(1, |q, _| q[0]).unwrap();
    assert!(start(other, 0.1).is_err());
    assert!(start(sigma(), 0.0).is_err() && start(sigma(), f64::NAN).is_err());
}

#[test]
#[ignore = "long: cargo test --release -p equip-solver --test all -- --ignored --nocapture reversible::long"]
fn long_runs_beside_the_tolerance() {
    // The direction of the pericentre and the position, after 10⁴ and 10⁵ revolutions of e = 0.6.
    let scene = kepler("0.6");
    let (q, p) = scene.initial::<f64>();
    let h = scene.hamiltonian();
    for periods in [1e4, 1e5] {
        let end = (periods + 0.3) * std::f64::consts::TAU;
        for method in [Equip::stages(6), Gauss::stages(6)] {
            let reversible = method.reversible(0.5, sigma()).record(Record::Ends);
            let tolerance = method.tolerance(1e-8).record(Record::Ends);
            for (name, run) in [
                ("reversible", reversible.integrate(h, &q, &p, 0.0..=end)),
                ("tolerance", tolerance.integrate(h, &q, &p, 0.0..=end)),
            ] {
                let run = run.unwrap();
                let (t, q1, p1) = run.last();
                let (q2, _) = scene.exact(t).unwrap();
                let error = (q1[0] - q2[0]).hypot(q1[1] - q2[1]);
                let l = q1[0] * p1[1] - q1[1] * p1[0];
                let r = q1[0].hypot(q1[1]);
                // The eccentricity vector starts along the first axis.
                let vector = (p1[1] * l - q1[0] / r, -p1[0] * l - q1[1] / r);
                let c = run.certificate();
                println!(
                    "{method}, {name}, {periods:.0e}: position {error:.1e}, pericentre turned {:.1e}, eccentricity {:.1e}, energy {:.1e}, {:.1} steps per revolution",
                    vector.1.atan2(vector.0),
                    vector.0.hypot(vector.1) - 0.6,
                    c.energy.as_ref().unwrap().end,
                    c.counts.steps as f64 / (periods + 0.3)
                );
            }
        }
    }
}
