//! Preconditioners: the same solution with each of them, at different cost.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_integrate::{
    Certificate, Counts, Equip, Gauss, IntegrateError, Integrator, Method, Outcome, Preconditioner,
};
use equip_scalar::{DoubleDouble, Float};
use equip_scenes::Instance;

const ALL: [Preconditioner; 4] = [
    Preconditioner::Identity,
    Preconditioner::Diagonal,
    Preconditioner::Frozen,
    Preconditioner::Full,
];

fn instance(name: &str, parameters: &[(&str, &str)]) -> Instance {
    equip_scenes::find(name)
        .unwrap()
        .instance(parameters)
        .unwrap()
}

/// Name, parameters, and the step as a quotient.
type Setting = (
    &'static str,
    &'static [(&'static str, &'static str)],
    (i64, i64),
);

/// Motion that is resolved, and none of it chaotic within a few steps.
const SCENES: [Setting; 7] = [
    ("kepler", &[("e", "0.6")], (1, 20)),
    ("henon-heiles", &[], (1, 4)),
    ("double-pendulum", &[], (1, 50)),
    ("dnls", &[], (1, 10)),
    ("fput-beta", &[], (1, 10)),
    ("outer-solar-system", &[], (50, 1)),
    ("sine-gordon", &[], (1, 10)),
];

/// Springs of which a step is an angle of 1/2 and 1: what keeps the energy moves the stages as far as the
/// direction turns.
const COARSE: [Setting; 2] = [("fpu", &[], (1, 100)), ("fpu", &[], (1, 50))];

/// Springs of which a step is many oscillations: hω = 10 and 50.
const STIFF: [Setting; 2] = [("fpu", &[], (1, 5)), ("fpu", &[("omega", "500")], (1, 10))];

/// Largest difference of two states, relative to the largest position or momentum.
fn difference<T: Float>(a: &[T], b: &[T]) -> f64 {
    let m = a.len() / 2;
    let mut worst = T::int(0);
    for group in [0..m, m..2 * m] {
        let (a, b) = (&a[group.clone()], &b[group]);
        let size = a.iter().fold(T::int(0), |most, x| most.max(x.abs()));
        let error = a.iter().zip(b).map(|(a, b)| (*a - *b).abs());
        let error = error.fold(T::int(0), |most, x| most.max(x));
        if size > T::int(0) {
            worst = worst.max(error / size);
        }
    }
    worst.to_f64()
}

/// States and outcomes of a run, or the error that ended it.
type States<T> = Result<Vec<(Vec<T>, Outcome)>, IntegrateError<T>>;

/// The states of a run, and the counts.
fn states<T: Float>(
    scene: &Instance,
    options: &Integrator<T>,
    (q, p): (&[T], &[T]),
    steps: usize,
) -> (States<T>, Counts) {
    let mut run = options.start(scene.hamiltonian(), q, p, T::int(0)).unwrap();
    let states = (0..steps).map(|_| {
        let view = run.advance()?;
        Ok(([view.q, view.p].concat(), view.outcome))
    });
    let states = states.collect();
    (states, *run.counts())
}

/// One step with each preconditioner from every state of a run; those that converge have one y1, to so many
/// ε.
///
/// Returns how many converged on all steps; none if they are not the same.
fn one_solution<T: Float>(setting: Setting, method: Method, starts: usize, most: f64) -> usize {
    let (name, parameters, (n, d)) = setting;
    let scene = instance(name, parameters);
    let h = T::ratio(n, d);
    let (q, p) = scene.initial::<T>();
    let options = method.step(h).max_halvings(0);
    let (run, _) = states(&scene, &options, (&q, &p), starts);
    let later = run.unwrap().into_iter().map(|(y, _)| y);
    let from: Vec<Vec<T>> = [[q, p].concat()].into_iter().chain(later).collect();
    let (mut worst, mut converged) = (0.0_f64, ALL.map(|_| true));
    for y in &from {
        let (q, p) = y.split_at(y.len() / 2);
        let ends = ALL.map(|m| {
            let options = options.clone().preconditioner(m);
            match states(&scene, &options, (q, p), 1).0 {
                Ok(mut states) => states.pop(),
                Err(IntegrateError::NoConvergence { .. } | IntegrateError::NotFinite { .. }) => {
                    None
                }
                Err(other) => panic!("{name}, {method}, {m:?}: {other}"),
            }
        });
        for (end, converged) in ends.iter().zip(&mut converged) {
            *converged &= end.is_some();
        }
        let mut found = ends.iter().flatten();
        let (first, outcome) = found.next().unwrap();
        for (other, found) in found {
            let off = difference(first, other) / T::EPSILON.to_f64();
            if !(off <= most) {
                println!("{name}, {method}: {off:.1e} ε, {outcome:?} and {found:?}");
            }
            worst = worst.max(off);
        }
    }
    println!("{name}, {method}, {}: {worst:.0} ε, {converged:?}", T::NAME);
    if worst <= most {
        converged.iter().filter(|&&converged| converged).count()
    } else {
        0
    }
}

const SAME: f64 = 1e3;

/// The scenes that do not have one solution with all four.
fn several_solutions<T: Float>(
    scenes: &[Setting],
    methods: &[Method],
    starts: usize,
) -> Vec<String> {
    let mut failed = Vec::new();
    for &method in methods {
        for &scene in scenes {
            if one_solution::<T>(scene, method, starts, SAME) != 4 {
                failed.push(format!("{}, {method}", scene.0));
            }
        }
    }
    failed
}

#[test]
fn one_solution_in_f64() {
    let [a, b] = [3, 6].map(Gauss::stages);
    let [c, d, e] = [3, 4, 6].map(Equip::stages);
    let failed = several_solutions::<f64>(&SCENES, &[a, b, c, d, e], 20);
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn one_solution_in_double_double() {
    let failed = several_solutions::<DoubleDouble>(&SCENES, &[Gauss::stages(4)], 3);
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
#[ignore = "known deficit: D has an error of the size of the displacement, which shows where that is large; 1000 ε allowed"]
fn one_solution_with_alpha_in_double_double() {
    let failed = several_solutions::<DoubleDouble>(&SCENES, &[Equip::stages(4)], 3);
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
#[ignore = "known deficit: hω = 1/2 and 1, s = 3 and 4: up to 1e10 ε between preconditioners, some steps solved with one and uncorrected with another"]
fn one_solution_of_a_coarse_step() {
    let failed = several_solutions::<f64>(&COARSE, &[3, 4, 6].map(Equip::stages), 20);
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn one_solution_of_stiff_stages() {
    for scene in STIFF {
        // Plain iterations do not contract.
        assert_eq!(one_solution::<f64>(scene, Gauss::stages(4), 20, SAME), 3);
        assert_eq!(
            one_solution::<DoubleDouble>(scene, Gauss::stages(4), 3, SAME),
            3
        );
    }
}

/// Distance after `steps` forwards and as many back, a step; `None` if a step was uncorrected: the next one
/// removes what it has left, and it does not do so on the way back.
fn there_and_back<T: Float>(
    setting: Setting,
    s: usize,
    steps: usize,
    m: Preconditioner,
) -> Option<f64> {
    let (name, parameters, (n, d)) = setting;
    let scene = instance(name, parameters);
    let options = Equip::stages(s).step(T::ratio(n, d)).preconditioner(m);
    let (q, p) = scene.initial::<T>();
    let flip = |y: &[T]| -> Vec<T> {
        let (q, p) = y.split_at(y.len() / 2);
        q.iter().copied().chain(p.iter().map(|&p| -p)).collect()
    };
    let there = states(&scene, &options, (&q, &p), steps).0.unwrap();
    let turned = flip(&there.last().unwrap().0);
    let (q1, p1) = turned.split_at(q.len());
    let back = states(&scene, &options, (q1, p1), steps).0.unwrap();
    let off = difference(&[q, p].concat(), &flip(&back.last().unwrap().0)) / steps as f64;
    let uncorrected =
        |states: &[(Vec<T>, Outcome)]| states.iter().filter(|(_, o)| o.is_uncorrected()).count();
    let uncorrected = [uncorrected(&there), uncorrected(&back)];
    println!(
        "{name}, s = {s}, {m:?}, {}: {off:.1e} a step, {uncorrected:?} uncorrected",
        T::NAME
    );
    (uncorrected == [0, 0]).then_some(off)
}

/// With three stages some of its steps have no α within reach.
const MAY_BE_UNCORRECTED: [&str; 1] = ["sine-gordon"];

/// The search direction is a function of the step, the same in both directions of time to second order in the
/// displacement.
#[test]
fn steps_run_backwards_alike() {
    let mut failed = Vec::new();
    for scene in SCENES {
        for s in [3, 4, 6] {
            for m in ALL {
                let off = there_and_back::<f64>(scene, s, 10, m);
                let may_be_uncorrected = s == 3 && MAY_BE_UNCORRECTED.contains(&scene.0);
                if off.is_none() && !may_be_uncorrected || off.is_some_and(|off| off >= 1e-13) {
                    failed.push(format!("{}, s = {s}, {m:?}: {off:?}", scene.0));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
#[ignore = "known deficit: 8.6e-21 a step on Kepler, s = 4, 1e-27 allowed: of second order in the displacement"]
fn steps_run_backwards_alike_in_double_double() {
    let mut failed = Vec::new();
    for scene in SCENES {
        for m in [Preconditioner::Identity, Preconditioner::Frozen] {
            let off = there_and_back::<DoubleDouble>(scene, 4, 3, m);
            if off.is_none_or(|off| off >= 1e-27) {
                failed.push(format!("{}, {m:?}: {off:?}", scene.0));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

/// Counts of 50 steps.
fn counted(setting: Setting, method: Method, m: Preconditioner) -> Counts {
    let (name, parameters, (n, d)) = setting;
    let scene = instance(name, parameters);
    let (q, p) = scene.initial::<f64>();
    let options = method.step(f64::ratio(n, d)).preconditioner(m);
    let (run, counts) = states(&scene, &options, (&q, &p), 50);
    run.unwrap();
    counts
}

#[test]
fn a_kept_factorisation_serves_for_many_steps() {
    let scene = ("fput-beta", [].as_slice(), (1, 10));
    let full = counted(scene, Gauss::stages(6), Preconditioner::Full);
    let frozen = counted(scene, Gauss::stages(6), Preconditioner::Frozen);
    println!("{full:?}\n{frozen:?}");
    // ∇²H at all stages: anew in every step.
    assert!(full.factorisations >= 50);
    assert_eq!(full.hessians, 6 * full.factorisations);
    // One ∇²H, with one complex matrix for each pair of stages.
    assert_eq!((frozen.hessians, frozen.simplified_factorisations), (1, 3));
    assert_eq!(
        (
            frozen.factorisations,
            frozen.preconditioner_changes,
            frozen.fixed_point_iterations
        ),
        (0, 0, 0)
    );
}

/// What is asked for is what is done, and what comes by itself is the cheapest that contracts.
#[test]
fn the_cheapest_that_contracts_is_taken() {
    let soft = ("fput-beta", [].as_slice(), (1, 10));
    let c = counted(soft, Equip::stages(4), Preconditioner::Automatic);
    assert_eq!((c.newton_iterations, c.preconditioner_changes), (0, 0));
    // Springs: no linear system, and fixed-point iteration is tried again after 1, 2, 4, … steps.
    let c = counted(STIFF[1], Gauss::stages(4), Preconditioner::Automatic);
    println!("{c:?}");
    assert!(
        c.preconditioner_changes > 0 && c.preconditioner_changes <= 7,
        "{c:?}"
    );
    assert_eq!(
        (c.factorisations, c.simplified_factorisations, c.halvings),
        (0, 0, 0)
    );
    // The same springs not along the components.
    let stiff = ("spring-pendulum", [("k", "1e6")].as_slice(), (1, 20));
    let c = counted(stiff, Gauss::stages(4), Preconditioner::Automatic);
    println!("{c:?}");
    assert!(c.newton_iterations > 0);
    assert_eq!(c.halvings, 0);
}

fn certificate(scene: &Instance, method: Method, h: f64, steps: usize) -> Certificate<f64> {
    let (q, p) = scene.initial::<f64>();
    let mut run = method
        .step(h)
        .start(scene.hamiltonian(), &q, &p, 0.0)
        .unwrap();
    for _ in 0..steps {
        run.advance().unwrap();
    }
    run.certificate()
}

#[test]
fn a_ring_of_a_thousand_sites() {
    let scene = instance("dnls", &[("n", "1000")]);
    let found = certificate(&scene, Equip::stages(4), 0.1, 20);
    println!("{found}");
    assert_eq!(found.counts.factorisations, 0);
    assert!(found.energy_conserved_on_every_step());
}

#[test]
fn iterations_that_do_not_contract_say_how_far_they_came() {
    let scene = instance("henon-heiles", &[]);
    let (q, p) = scene.initial::<f64>();
    let failed = Equip::stages(4)
        .step(50.0)
        .max_halvings(0)
        .preconditioner(Preconditioner::Identity)
        .integrate(scene.hamiltonian(), &q, &p, 0.0..=50.0)
        .unwrap_err();
    match failed.error {
        IntegrateError::NotFinite { .. } => {}
        IntegrateError::NoConvergence {
            iterations,
            correction,
            ..
        } => assert!(iterations > 1 && correction.is_finite()),
        other => panic!("{other}"),
    }
}

/// What the last iteration leaves of Z − K L is an error of quadratic invariants that repeats from period to
/// period: iterations go on until it is rounding. Kepler e = 0.6, angular momentum 0.8, 1000 periods.
#[test]
fn angular_momentum_is_left_to_rounding_alone() {
    let scene = instance("kepler", &[("e", "0.6")]);
    let (q, p) = scene.initial::<f64>();
    let mut failed = Vec::new();
    for m in ALL {
        for (s, per_period) in [(3, 160), (4, 100), (6, 48)] {
            let mut stepper = Equip::stages(s)
                .step(std::f64::consts::TAU / f64::from(per_period))
                .preconditioner(m)
                .start(scene.hamiltonian(), &q, &p, 0.0)
                .unwrap();
            let start = q[0] * p[1] - q[1] * p[0];
            let (mut worst, mut last) = (0.0_f64, 0.0);
            for _ in 0..1000 * per_period {
                let view = stepper.advance().unwrap();
                last = view.q[0] * view.p[1] - view.q[1] * view.p[0] - start;
                worst = worst.max(last.abs());
            }
            println!("{m:?}, s = {s}: worst {worst:.1e}, at the end {last:.1e}");
            // 1.7e-14 with corrections of 4 ε left over (s = 3).
            if worst > ANGULAR_MOMENTUM {
                failed.push(format!("{m:?}, s = {s}: {worst:.1e}"));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

const ANGULAR_MOMENTUM: f64 = 4e-15;
