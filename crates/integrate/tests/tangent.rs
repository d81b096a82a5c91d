//! The tangent map against finite differences, and what it says about chaos.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{
    ChaosIndicators, Checkpoint, Equip, Event, Gauss, IntegrateError, Method, NoObserver, Observer,
    StepView, TangentMap,
};
use equip_scalar::{DoubleDouble, Float};
use std::ops::ControlFlow;

fn henon_heiles(energy: &str, q2: &str, p2: &str) -> equip_scenes::Instance {
    let values = [("energy", energy), ("q2", q2), ("p2", p2)];
    equip_scenes::find("henon-heiles")
        .unwrap()
        .instance(&values)
        .unwrap()
}

type D = DoubleDouble;

#[test]
fn it_is_the_derivative_of_the_step_map() {
    let scene = henon_heiles("1/8", "-0.1", "0.05");
    let (q, p) = scene.initial::<D>();
    let h = scene.hamiltonian();
    let tiny = D::decimal("1e-10").unwrap();
    let step = D::decimal("0.3").unwrap();
    let steps = 5;
    let end = |method: Method, q: &[D], p: &[D]| {
        let mut run = method.step(step).start(h, q, p, D::int(0)).unwrap();
        for _ in 0..steps {
            run.advance().unwrap();
        }
        [run.view().q, run.view().p].concat()
    };
    for (method, bound) in [(Gauss::stages(3), 1e-18), (Equip::stages(3), 2e-6)] {
        let mut run = method.step(step).start(h, &q, &p, D::int(0)).unwrap();
        let mut tangent = TangentMap::new(h, &mut run);
        let mut columns: Vec<D> = (0..16).map(|i| D::int(i64::from(i % 5 == 0))).collect();
        for _ in 0..steps {
            run.advance().unwrap();
            tangent.propagate(&run, &mut columns).unwrap();
        }
        let mut worst = 0.0f64;
        for (j, column) in columns.chunks(4).enumerate() {
            let moved = |by: D| {
                let mut y = [q.as_slice(), &p].concat();
                y[j] += by;
                end(method, &y[..2], &y[2..])
            };
            let (ahead, behind) = (moved(tiny), moved(-tiny));
            for i in 0..4 {
                let difference = (ahead[i] - behind[i]) / (D::int(2) * tiny);
                worst = worst.max((difference - column[i]).abs().to_f64());
            }
        }
        println!("{method}: {worst:.1e}");
        // Gauss: measured 4e-21, the error of the difference. EQUIP: what the turn of the direction adds.
        assert!(worst < bound);
        // EQUIP: tangent vectors conserve the energy, ∇H·δ.
        let view = run.view();
        let [before, after] = [(&*q, &*p), (view.q, view.p)].map(|(q, p)| {
            let mut gradient = vec![D::int(0); 4];
            let mut evaluator = h.evaluator::<D>();
            evaluator.gradient(&[q, p].concat(), &mut gradient);
            gradient
        });
        for (j, column) in columns.chunks(4).enumerate() {
            let sum = after
                .iter()
                .zip(column)
                .fold(D::int(0), |sum, (&g, &x)| sum + g * x);
            let most = if method == Equip::stages(3) {
                1e-27
            } else {
                1e-4
            };
            assert!((sum - before[j]).abs().to_f64() < most, "{method}");
        }
        if method == Equip::stages(3) {
            continue;
        }
        // Symplectic: Ψᵀ J Ψ = J.
        let form = |a: &[D], b: &[D]| (a[0] * b[2] + a[1] * b[3]) - (a[2] * b[0] + a[3] * b[1]);
        for i in 0..4 {
            for j in 0..4 {
                let exact = i64::from(j == i + 2) - i64::from(i == j + 2);
                let found = form(&columns[4 * i..][..4], &columns[4 * j..][..4]);
                assert!((found - D::int(exact)).abs().to_f64() < 1e-29);
            }
        }
    }
}

/// λ and MEGNO along an orbit of energy 1/8, at the times given.
fn indicators(q2: &str, p2: &str, times: &[f64]) -> Vec<ChaosIndicators<f64>> {
    let scene = henon_heiles("1/8", q2, p2);
    let (q, p) = scene.initial::<f64>();
    let mut seen = Vec::new();
    let mut observe = |view: &StepView<'_, f64>| {
        if times.get(seen.len()).is_some_and(|&t| view.time >= t) {
            seen.extend(view.chaos);
        }
        ControlFlow::Continue(())
    };
    let end = times.last().unwrap();
    let options = Equip::stages(6).tolerance(1e-9).chaos();
    let run = options
        .integrate_observed(scene.hamiltonian(), &q, &p, 0.0..=*end, &mut observe)
        .unwrap();
    assert_eq!(seen.last(), run.certificate().chaos.as_ref());
    assert_eq!(seen.len(), times.len());
    seen
}

#[test]
fn order_and_chaos_of_henon_heiles() {
    // Orbits that the literature on chaos indicators shares: x = 0, y = -0.25, px = 0.42, py = 0 is chaotic
    // with a largest exponent of about 0.047 (Skokos, Bountis, Antonopoulos, Geometrical properties of local
    // dynamics in Hamiltonian systems: the Generalized Alignment Index (GALI) method, Physica D 231 (2007),
    // 4.1; Skokos, The Lyapunov characteristic exponents and their computation, Lect. Notes Phys. 790
    // (2010)); x = 0, y = 0.483, px = 0.27898, py = 0 is quasi-periodic (tests of DynamicalSystems.jl, which
    // have both).
    let times = [1e3, 1e4, 5e4];
    let chaotic = indicators("-0.25", "0", &times);
    for (t, x) in times.iter().zip(&chaotic) {
        println!(
            "chaotic, t = {t:e}: {x:?}, λt/2 = {:.1}",
            x.lyapunov * t / 2.0
        );
    }
    // λ(t) of a chaotic orbit wanders, MEGNO, a mean over time, with it, and any rounding leads to another
    // orbit: λ measured 0.025 to 0.056 at t = 5·10⁴ on 16 neighbours, MEGNO 0.78 to 1.13 of λt/2 on these.
    let neighbours = ["-0.2500000001", "-0.2500000002", "-0.2500000003"];
    let mut all = neighbours.map(|q2| indicators(q2, "0", &times)).to_vec();
    all.push(chaotic);
    let mean = |f: &dyn Fn(f64, &ChaosIndicators<f64>) -> f64, k: usize| {
        all.iter().map(|seen| f(times[k], &seen[k])).sum::<f64>() / 4.0
    };
    for (k, t) in times.iter().enumerate() {
        let ratio = mean(&|t, x| x.megno / (x.lyapunov * t / 2.0), k);
        println!("MEGNO at t = {t:e}: {ratio:.3} of λt/2");
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }
    let found = mean(&|_, x| x.lyapunov, 2);
    println!("λ = {found:.4}");
    assert!((found - 0.047).abs() < 0.35 * 0.047, "{found}");
    let regular = indicators("0.483", "0", &times[..2]);
    for (t, x) in times.iter().zip(&regular) {
        println!("regular, t = {t:e}: {x:?}");
        // λ falls like ln t / t: measured 0.67 and 0.73 of it. MEGNO measured 1.87 and 1.99.
        assert!(x.lyapunov < 1.5 * t.ln() / t && (x.megno - 2.0).abs() < 0.2);
    }
}

/// Keeps the checkpoint after step 40.
#[derive(Default)]
struct Keep(u64, Option<Checkpoint>);

impl Observer<f64> for Keep {
    fn step(&mut self, view: &StepView<'_, f64>) -> ControlFlow<()> {
        self.0 = view.index;
        ControlFlow::Continue(())
    }

    fn wants_checkpoint(&mut self) -> bool {
        self.0 == 40
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        self.1 = Some(checkpoint);
        ControlFlow::Continue(())
    }
}

#[test]
fn a_followed_run_has_the_same_steps_and_is_resumed_bit_for_bit() {
    let scene = henon_heiles("1/8", "-0.25", "0");
    let (q, p) = scene.initial::<f64>();
    let h = scene.hamiltonian();
    let plain = Equip::stages(5).step(0.5);
    let options = plain.clone().chaos();
    let mut keep = Keep::default();
    let whole = options
        .integrate_observed(h, &q, &p, 0.0..=50.0, &mut keep)
        .unwrap();
    let alone = plain.integrate(h, &q, &p, 0.0..=50.0).unwrap();
    assert_eq!(whole.last(), alone.last());
    assert_eq!(alone.certificate().chaos, None);
    let checkpoint = keep.1.unwrap();
    let rest = options
        .integrate_from(h, &checkpoint, 50.0, &mut NoObserver)
        .unwrap();
    assert!(whole.certificate().chaos.is_some());
    assert_eq!(whole.certificate().chaos, rest.certificate().chaos);
    // A checkpoint of a run that followed nothing has nothing to go on from.
    let mut keep = Keep::default();
    plain
        .integrate_observed(h, &q, &p, 0.0..=50.0, &mut keep)
        .unwrap();
    let failure = options
        .integrate_from(h, &keep.1.unwrap(), 50.0, &mut NoObserver)
        .unwrap_err();
    assert!(matches!(
        failure.error,
        IntegrateError::CheckpointMismatch {
            what: "tangent vector",
            ..
        }
    ));
}

#[test]
fn steps_that_fixed_point_iteration_does_not_solve_are_followed_too() {
    // hω = 4: the linearised stages are solved by a factorisation. A quarter turn and more of the rotation,
    // to round-off.
    let omega = 40.0;
    let h = Hamiltonian::new(1, move |q, p| {
        0.5 * (p[0] * p[0] + omega * omega * q[0] * q[0])
    })
    .unwrap();
    let mut run = Gauss::stages(10)
        .step(0.1)
        .start(&h, &[1.0], &[0.0], 0.0)
        .unwrap();
    let mut tangent = TangentMap::new(&h, &mut run);
    let mut tangent_vector = vec![1.0, 0.0];
    for _ in 0..5 {
        run.advance().unwrap();
        tangent.propagate(&run, &mut tangent_vector).unwrap();
    }
    // The tangent map of a linear system is its step.
    let error = (tangent_vector[0] - run.view().q[0])
        .abs()
        .max((tangent_vector[1] - run.view().p[0]).abs() / omega);
    println!("{error:.1e}");
    assert!(error < 1e-13);
}

/// Beside the error of the states: that of their derivatives in the direction of the initial momentum, along
/// which the period changes most.
#[test]
fn tangent_vectors_are_as_accurate_as_states() {
    let scene = equip_scenes::find("kepler").unwrap();
    let scene = scene.instance(&[("e", "0.6")]).unwrap();
    let h = scene.hamiltonian();
    let (q, p) = scene.initial::<f64>();
    let (periods, steps) = (4.16, 512_u32);
    let end = periods * scene.period::<f64>();
    let run = |method: Method, parts: u32| {
        let count = steps * parts;
        let step = end / f64::from(count);
        let mut run = method.step(step).start(h, &q, &p, 0.0).unwrap();
        let mut tangent = TangentMap::new(h, &mut run);
        let mut columns: Vec<f64> = (0..16).map(|i| f64::from(u8::from(i % 5 == 0))).collect();
        for _ in 0..count {
            run.advance().unwrap();
            tangent.propagate(&run, &mut columns).unwrap();
        }
        ([run.view().q, run.view().p].concat(), columns)
    };
    let apart = |x: &[f64], y: &[f64]| {
        let most = |f: &dyn Fn(usize) -> f64| (0..x.len()).map(f).fold(0.0, f64::max);
        most(&|i| (x[i] - y[i]).abs()) / most(&|i| y[i].abs())
    };
    let exact = run(Gauss::stages(12), 1);
    for method in [Gauss::stages(4), Equip::stages(4), Equip::stages(6)] {
        let found = run(method, 1);
        let (state, tangent) = (apart(&found.0, &exact.0), apart(&found.1, &exact.1));
        println!("{method}: states {state:.1e}, tangent vectors {tangent:.1e}");
        assert!(
            tangent <= 3.0 * state + 1e-12,
            "{method}: {tangent:e}, {state:e}"
        );
    }
}

/// Across the plane q2 = 0, which the orbit does not leave, the motion is 100 times as fast as within it. The
/// reference is DOP853 of SciPy 1.17.1, rtol 2.3e-14.
#[test]
fn tangent_vectors_faster_than_the_orbit() {
    let h = Hamiltonian::new(2, |q, p| {
        (p[0] * p[0] + p[1] * p[1]) / 2
            + 0.005 * q[0] * q[0]
            + 50.0 * q[1] * q[1] * (1.0 + 0.1 * q[0])
    })
    .unwrap();
    let across = |longest: f64| {
        let method = Equip::stages(8).tolerance(1e-12).max_step(longest);
        let mut run = method.start(&h, &[1.0, 0.0], &[0.0; 2], 0.0).unwrap();
        let mut tangent = TangentMap::new(&h, &mut run);
        let mut vector = [0.0, 1.0, 0.0, 0.0];
        tangent.advance_to(&mut run, 1.0, &mut vector).unwrap();
        (vector, run.certificate().motion_is_resolved())
    };
    let (vector, is_resolved) = across(10.0);
    assert!(!is_resolved && (vector[1] - REFERENCE[0]).abs() > 1e-3);
    let (vector, is_resolved) = across(0.1);
    assert!(is_resolved);
    for (found, expected) in [vector[1], vector[3]].iter().zip(REFERENCE) {
        assert!((found - expected).abs() < 1e-11, "{vector:?}");
    }
}

const REFERENCE: [f64; 2] = [-0.4867212361321, 9.161128210067];

/// At the upper equilibrium of a pendulum, where nothing limits the steps, λ = 1.
#[test]
fn chaos_at_an_equilibrium() {
    let h = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2 + q[0].cos()).unwrap();
    let lyapunov = |longest: f64| {
        let method = Equip::stages(8).tolerance(1e-12).max_step(longest).chaos();
        let run = method.integrate(&h, &[0.0], &[0.0], 0.0..=100.0).unwrap();
        let certificate = run.certificate();
        (
            certificate.chaos.unwrap().lyapunov,
            certificate.motion_is_resolved(),
        )
    };
    let (found, is_resolved) = lyapunov(1e3);
    assert!(!is_resolved && (found - 1.0).abs() > 0.1, "{found}");
    let (found, is_resolved) = lyapunov(1.0);
    // δ grows like eᵗ after a time of order one.
    assert!(is_resolved && (found - 1.0).abs() < 0.02, "{found}");
}

/// The derivative of the change is not known, and without it the exponent of a kicked rotor is 0.01 for 0.96.
#[test]
fn chaos_with_events_that_change_the_state() {
    let h = Hamiltonian::new(1, |_, p| p[0] * p[0] / 2).unwrap();
    let kick = Event::new("kick", |t: f64, _: &[f64], _: &[f64]| (t * 3.0).sin());
    let kick = kick.then(|_, q, p| {
        p[0] += q[0].sin();
        ControlFlow::Continue(())
    });
    let method = Equip::stages(4).step(0.25).chaos().event(kick);
    let failure = method.integrate(&h, &[0.3], &[0.2], 0.0..=5.0).unwrap_err();
    let event = "kick".to_owned();
    assert_eq!(failure.error, IntegrateError::ChaosWithChange { event });
}
