use equip_autodiff::*;
use equip_scalar::*;
use std::hint::black_box;
use std::time::Instant;
fn best(mut f: impl FnMut(), points: usize) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..30 {
        let t = Instant::now();
        for _ in 0..20000 {
            f();
        }
        best = best.min(t.elapsed().as_secs_f64() / 20000.0);
    }
    best * 1e9 / points as f64
}
fn main() {
    let kepler = hamiltonian!(2, |q, p| 0.5 * (p[0] * p[0] + p[1] * p[1])
        - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt())
    .unwrap();
    let hh = hamiltonian!(2, |q, p| (p[0].powi(2)
        + p[1].powi(2)
        + q[0].powi(2)
        + q[1].powi(2))
        / 2.0
        + q[0].powi(2) * q[1]
        - ratio(1, 3) * q[1].powi(3))
    .unwrap();
    let arr = [&kepler.clone()];
    let _ = arr;
    run("kepler", &kepler);
    run("hh", &hh);
    let k: Vec<f64> = (0..64).map(|i| (i as f64).sin()).collect();
    for set in InstructionSet::available() {
        let l: Vec<f64> = (0..32).map(|i| (i as f64).cos()).collect();
        let mut z = vec![0.0; 32];
        println!(
            "{set:?} mix 4 components 8 stages {:.2} ns",
            best(
                || mix_stages(set, black_box(&k), black_box(&l), black_box(&mut z), 8, 8),
                1
            )
        );
    }
}
fn run<H: System>(name: &str, h: &H) {
    let mut e = h.evaluator::<f64>();
    for set in InstructionSet::available() {
        e.set_instruction_set(set);
        let y: Vec<f64> = (0..32).map(|i| 1.0 + (i as f64).sin() * 0.2).collect();
        let mut g = vec![0.0; 32];
        let a = best(
            || e.gradients_by_component(black_box(&y), black_box(&mut g), 8, 8),
            8,
        );
        let b = best(
            || e.forces_by_component(black_box(&y[..16]), black_box(&mut g[..16]), 8, 8),
            8,
        );
        let c = best(|| e.gradients(black_box(&y), black_box(&mut g), 4), 8);
        println!("{name} {set:?}: gradient {a:.2} forces {b:.2} scalar {c:.2} ns per point");
    }
}
