//! How the work of a step grows: with the size of the system not at all but for the size itself, with the
//! stages slowly. Counts, no clock.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_integrate::{Counts, Equip, Gauss, Method, Outcome, Preconditioner};
use equip_scalar::Constant;
use equip_scenes::Instance;
use equip_scenes::energies::{FputBeta, Model as _};
use equip_tests::{Start, henon_heiles, kepler};

fn counts(
    method: Method,
    h: f64,
    steps: u64,
    (energy, q, p): (&Hamiltonian, &[f64], &[f64]),
    solver: Preconditioner,
) -> Counts {
    let options = method.step(h).preconditioner(solver);
    let mut run = options.start(energy, q, p, 0.0).unwrap();
    for _ in 0..steps {
        run.advance().unwrap();
    }
    *run.counts()
}

fn per_step(count: u64, counts: &Counts) -> f64 {
    count as f64 / counts.steps as f64
}

fn instance(scene: &str, n: usize) -> Instance {
    let n = n.to_string();
    equip_scenes::find(scene)
        .unwrap()
        .instance(&[("n", &n)])
        .unwrap()
}

/// Gradients a step of chains of 16 to 1024 masses in their first mode, s = 4, h = 0.2: the work of a step is
/// a number of gradients that does not grow, times that of one, which is linear in n.
#[test]
fn a_longer_chain_takes_no_more_gradients() {
    // Measured: see what is printed; headroom of 1.15 for the first. Longer chains are smoother, down to two
    // iterations a step.
    for (method, most) in [(Gauss::stages(4), 25.0), (Equip::stages(4), 28.0)] {
        for n in [16, 64, 256, 1024] {
            let chain = instance("fput-beta", n);
            let (q, p) = chain.initial::<f64>();
            let start = (chain.hamiltonian(), q.as_slice(), p.as_slice());
            let c = counts(method, 0.2, 20, start, Preconditioner::Identity);
            let gradients = per_step(c.gradients, &c);
            assert!(gradients <= most, "{method}, n = {n}: {gradients} a step");
            println!("{method}, n = {n}: {gradients:.1}");
            assert_eq!(c.hessians + c.factorisations, 0);
        }
    }
}

/// The same for bodies in a ring, whose pairs are n(n − 1)/2.
#[test]
fn more_bodies_take_no_more_gradients() {
    for n in [3, 10, 30] {
        let ring = instance("n-body", n);
        let (q, p) = ring.initial::<f64>();
        let start = (ring.hamiltonian(), q.as_slice(), p.as_slice());
        let h = ring.suggested_step() / 4.0;
        let c = counts(Equip::stages(4), h, 10, start, Preconditioner::Identity);
        let gradients = per_step(c.gradients, &c);
        // Measured 14.3, 14.4, 13.7; headroom of 1.15.
        assert!(gradients <= 16.5, "n = {n}: {gradients} a step");
    }
}

/// Iterations a step of EQUIP with the same number of stages in a revolution for all s: they hardly depend on
/// s.
#[test]
fn more_stages_take_few_more_iterations() {
    let scenes = [
        // Measured 6.85, 4.32, 4.21, 4.49, 5.27 (Gauss 4.50, 4.47, 4.31, 4.33, 5.15); headroom of 1.15.
        (kepler::<f64>(6), 0.02, [7.9, 5.0, 4.9, 5.2, 6.1]),
        // Measured 7.31, 4.73, 4.72, 4.58, 5.89 (Gauss 5.02, 5.01, 5.01, 4.97, 5.48); headroom of 1.15.
        (
            henon_heiles(0.125, "0.3", "0"),
            0.04,
            [8.4, 5.5, 5.5, 5.3, 6.8],
        ),
    ];
    for (i, ((energy, Start { q, p }), h, most)) in scenes.iter().enumerate() {
        for (s, most) in [4_usize, 6, 8, 12, 16].into_iter().zip(most) {
            let start = (energy, q.as_slice(), p.as_slice());
            let method = Equip::stages(s);
            let c = counts(method, h * s as f64, 400, start, Preconditioner::Identity);
            let iterations = per_step(c.fixed_point_iterations, &c);
            assert!(
                iterations <= *most,
                "scene {i}, s = {s}: {iterations} a step"
            );
        }
    }
}

/// A chain of 16384 masses in its first mode takes the gradients a step of one of 256: the value of H is not
/// hidden by rounding its partial sums, so there are no defects to be removed where there are none.
#[test]
fn the_longest_chain_takes_no_more_gradients() {
    let gradients = |n: usize| {
        let chain = FputBeta {
            n,
            beta: Constant::from(0.3),
            amplitude: Constant::from(10.0),
        };
        let energy = chain.hamiltonian().unwrap();
        let mode = |i: usize| 10.0 * (std::f64::consts::PI * i as f64 / (n + 1) as f64).sin();
        let q: Vec<f64> = (1..=n).map(mode).collect();
        let p = vec![0.0; n];
        let start = (&energy, q.as_slice(), p.as_slice());
        let c = counts(Equip::stages(4), 0.2, 20, start, Preconditioner::Automatic);
        println!("{n}: {c:?}");
        assert_eq!(c.outcome(Outcome::Solved) + c.newton_iterations, 0);
        per_step(c.gradients, &c)
    };
    let (short, long) = (gradients(256), gradients(16384));
    assert!(long <= 1.15 * short, "{short} and {long}");
}

/// A chain at rest positions, its momenta without order.
fn at_rest(n: usize) -> (Instance, Vec<f64>, Vec<f64>) {
    let momentum = |i: usize| ((i * i) as f64 * 0.731).sin();
    let p = (0..n).map(momentum).collect();
    (instance("fput-beta", n), vec![0.0; n], p)
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// A chain at rest positions, its momenta without order: sizes of the positions are known after the first
/// iteration only, and some are very small.
#[test]
fn a_chain_at_rest_is_iterated_from_the_first_step() {
    let (instance, q, p) = at_rest(256);
    let end = |steps: u64, s: usize| {
        let options = Equip::stages(s).step(4.0 / steps as f64);
        let options = options.preconditioner(Preconditioner::Identity);
        let mut run = options.start(instance.hamiltonian(), &q, &p, 0.0).unwrap();
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            let view = run.advance().unwrap();
            worst = worst.max(view.energy_error.unwrap().abs());
        }
        let (counts, view) = (*run.counts(), run.view());
        assert_eq!(counts.preconditioner_changes + counts.halvings, 0);
        ([view.q, view.p].concat(), worst)
    };
    let (coarse, defect) = end(4, 16);
    let (fine, _) = end(40, 6);
    let apart = apart(&coarse, &fine);
    assert!(apart <= 1e-11, "{apart:e}");
    // H is some 60.
    assert!(defect <= 1e-13, "{defect:e}");
}

/// Steps of a chain of 1024 masses without order, hω = 2: where one component is small beside its neighbours
/// their rounding is 30 ε of it. Newton's method, which does away with none of it, took 40 steps' time for
/// one.
#[test]
fn rounding_among_many_components_is_no_matter_for_newton() {
    let (instance, q, p) = at_rest(1024);
    let end = |method: Method, steps: u64| {
        let options = method.step(50.0 / steps as f64);
        let mut run = options.start(instance.hamiltonian(), &q, &p, 0.0).unwrap();
        for _ in 0..steps {
            run.advance().unwrap();
        }
        let (counts, view) = (*run.counts(), run.view());
        assert_eq!(
            counts.newton_iterations + counts.preconditioner_changes,
            0,
            "{steps}"
        );
        assert!(view.energy_error.unwrap().abs() <= 1e-12);
        [view.q, view.p].concat()
    };
    let fine = end(Gauss::stages(16), 80);
    for steps in [40, 50] {
        let apart = apart(&end(Equip::stages(16), steps), &fine);
        println!("{steps}: {apart:e}");
        assert!(apart <= 1e-12, "{apart:e}");
    }
}
