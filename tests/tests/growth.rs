//! How the work of a step grows: with the size of the system not at all but for the size itself, with the stages slowly. Counts, no clock.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_scenes::Instance;
use equip_solver::{Counts, Equip, Gauss, Method, StageSolver};
use equip_tests::{Start, henon_heiles, kepler};

fn counts(
    method: Method,
    h: f64,
    steps: u64,
    (energy, q, p): (&Hamiltonian, &[f64], &[f64]),
    solver: StageSolver,
) -> Counts {
    let options = method.step(h).stage_solver(solver);
    let mut run = options.start(energy, q, p, 0.0).unwrap();
    for _ in 0..steps {
        run.advance().unwrap();
    }
    run.counts().clone()
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

/// Gradients and sweeps a step of chains of 16 to 1024 masses, s = 4, h = 0.2: the work of a step then is that of a gradient,
/// linear in n, times a constant.
#[test]
fn a_longer_chain_takes_no_more_sweeps() {
    for (method, most) in [(Gauss::stages(4), 0.0), (Equip::stages(4), 0.0)] {
        for n in [16, 64, 256, 1024] {
            let chain = instance("fput-beta", n);
            let (q, p) = chain.initial::<f64>();
            let start = (chain.hamiltonian(), q.as_slice(), p.as_slice());
            let c = counts(method, 0.2, 20, start, StageSolver::Sweeps);
            let (sweeps, gradients) = (per_step(c.sweeps, &c), per_step(c.gradients, &c));
            println!("{method} n = {n}: {sweeps} sweeps, {gradients} gradients");
            assert!(gradients <= most, "{method} n = {n}: {gradients} gradients a step");
            assert_eq!(c.hessians + c.factorisations, 0);
        }
    }
}

/// The same for bodies in a ring.
#[test]
fn more_bodies_take_no_more_sweeps() {
    for n in [3, 10, 30] {
        let ring = instance("n-body", n);
        let (q, p) = ring.initial::<f64>();
        let start = (ring.hamiltonian(), q.as_slice(), p.as_slice());
        let h = ring.suggested_step() / 4.0;
        let c = counts(Equip::stages(4), h, 10, start, StageSolver::Sweeps);
        let gradients = per_step(c.gradients, &c);
        println!("n = {n}: {gradients} gradients");
        assert!(gradients <= 0.0, "n = {n}: {gradients} gradients a step");
    }
}

/// Sweeps a step with the same number of stages in a revolution: they grow slowly with s, and those of EQUIP stay near those of Gauss.
#[test]
fn more_stages_take_few_more_sweeps() {
    let scenes = [
        ("Kepler", kepler::<f64>(6), 0.02),
        ("Hénon–Heiles", henon_heiles(0.125, "0.3", "0"), 0.04),
    ];
    for (name, (energy, Start { q, p }), h) in &scenes {
        for (s, most) in [(4, 0.0), (6, 0.0), (8, 0.0), (12, 0.0), (16, 0.0)] {
            let start = (energy, q.as_slice(), p.as_slice());
            let sweeps = |method| {
                let c = counts(method, h * s as f64, 400, start, StageSolver::Sweeps);
                per_step(c.sweeps, &c)
            };
            let (gauss, equip) = (sweeps(Gauss::stages(s)), sweeps(Equip::stages(s)));
            println!("{name} s = {s}: {gauss} {equip}");
            assert!(equip <= most, "{name}, s = {s}: {equip} sweeps a step, Gauss {gauss}");
        }
    }
}
