//! Full and simplified Newton solve the same equations: same trajectories, less work.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_scalar::{DoubleDouble, Float};
use equip_scenes::Instance;
use equip_solver::{Certificate, Equip, Gauss, Method, Outcome, StageSolver};

struct Ran<T> {
    states: Vec<Vec<T>>,
    certificate: Certificate<T>,
    seconds: f64,
}

fn run<T: Float>(
    scene: &Instance,
    method: Method,
    (h, steps): (T, usize),
    solver: StageSolver,
) -> Ran<T> {
    let (q, p) = scene.initial::<T>();
    let options = method.step(h).stage_solver(solver);
    let mut stepper = options
        .start(scene.hamiltonian(), &q, &p, T::int(0))
        .unwrap();
    let begun = std::time::Instant::now();
    let mut states = Vec::new();
    for _ in 0..steps {
        let view = stepper.advance().unwrap();
        states.push([view.q, view.p].concat());
    }
    Ran {
        states,
        certificate: stepper.certificate(),
        seconds: begun.elapsed().as_secs_f64(),
    }
}

/// Largest difference over the run, relative to the largest position or momentum.
fn difference<T: Float>(a: &Ran<T>, b: &Ran<T>) -> f64 {
    let mut worst = T::int(0);
    for (a, b) in a.states.iter().zip(&b.states) {
        let m = a.len() / 2;
        for group in [0..m, m..2 * m] {
            let (a, b) = (&a[group.clone()], &b[group]);
            let size = a.iter().fold(T::int(0), |max, x| max.max(x.abs()));
            let error = a.iter().zip(b).map(|(a, b)| (*a - *b).abs());
            let error = error.fold(T::int(0), |max, x| max.max(x));
            if size > T::int(0) {
                worst = worst.max(error / size);
            }
        }
    }
    worst.to_f64()
}

fn instance(name: &str, parameters: &[(&str, &str)]) -> Instance {
    equip_scenes::find(name)
        .unwrap()
        .instance(parameters)
        .unwrap()
}

/// (scene, parameters, h as a quotient)
const SCENES: [(&str, &[(&str, &str)], (i64, i64)); 5] = [
    ("dnls", &[], (1, 10)),
    ("fput-beta", &[], (1, 10)),
    ("outer-solar-system", &[], (50, 1)),
    ("fpu", &[], (1, 50)),
    ("sine-gordon", &[], (1, 10)),
];

fn agree<T: Float>(steps: usize, s: usize, equip: bool) {
    for (name, parameters, (n, d)) in SCENES {
        let scene = instance(name, parameters);
        let h = T::ratio(n, d);
        let method: Method = if equip {
            Equip::stages(s).into()
        } else {
            Gauss::stages(s).into()
        };
        let full = run(&scene, method, (h, steps), StageSolver::FullNewton);
        let simplified = run(&scene, method, (h, steps), StageSolver::SimplifiedNewton);
        let (f, g) = (&full.certificate, &simplified.certificate);
        println!(
            "{name} {} {method}: difference {:.1e}; full {} it, {} fact, {:.3} s, {:.1e} (floors {:?}); simplified {} it, {} refreshes, {} small, {} hess, {:.3} s, {:.1e} (floors {:?}) carried {} {}",
            T::NAME,
            difference(&full, &simplified),
            f.counts.newton_iterations,
            f.counts.factorisations,
            full.seconds,
            f.energy.as_ref().unwrap().max,
            f.energy_in_floors.map(|x| x.to_f64()),
            g.counts.newton_iterations,
            g.counts.refreshes,
            g.counts.simplified_factorisations,
            g.counts.hessians,
            simplified.seconds,
            g.energy.as_ref().unwrap().max,
            g.energy_in_floors.map(|x| x.to_f64()),
            f.counts.outcome(Outcome::Carried),
            g.counts.outcome(Outcome::Carried),
        );
    }
}

#[test]
fn scan() {
    for s in [3, 4, 6] {
        agree::<f64>(50, s, false);
        agree::<f64>(50, s, true);
    }
    agree::<DoubleDouble>(3, 4, false);
    agree::<DoubleDouble>(3, 4, true);
}

#[test]
fn long_chain() {
    for n in ["250", "500", "1000"] {
        let scene = instance("dnls", &[("n", n)]);
        for method in [Gauss::stages(4), Equip::stages(4)] {
            let ran = run(&scene, method, (0.1, 20), StageSolver::Automatic);
            println!("dnls {n}: {:.3} s\n{}", ran.seconds, ran.certificate);
        }
    }
}
