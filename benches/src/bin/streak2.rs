//! Scratch.
#![allow(missing_docs, dead_code, clippy::all, clippy::unwrap_used)]
use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Gauss};
fn main() {
    let k = 1e6;
    let spring = Hamiltonian::new(2, |q, p| {
        let stretch = (q[0] * q[0] + q[1] * q[1]).sqrt() - 1.0;
        0.5 * (p[0] * p[0] + p[1] * p[1]) + 0.5 * k * stretch * stretch + q[1]
    })
    .unwrap();
    for (q, p) in [([1.0, 0.0], [0.0, 0.0]), ([1.001, 0.0], [0.2, 0.5])] {
        for s in [6, 8] {
            for angle in [0.42, 0.55] {
                let h = angle / 1000.0;
                let steps = 4000;
                let run = |m: equip_integrate::Method, h: f64, n: u64| {
                    let mut r = m.step(h).start(&spring, &q, &p, 0.0).unwrap();
                    for _ in 0..n {
                        r.advance().unwrap();
                    }
                    let v = r.view();
                    println!(
                        "   {:?} carried {} le {}",
                        v.energy_defect,
                        r.counts().carried(),
                        r.counts().local_errors
                    );
                    (v.q.to_vec(), v.p.to_vec())
                };
                let reference = run(Gauss::stages(16), h / 2.0, 2 * steps);
                let e = |a: &(Vec<f64>, Vec<f64>)| {
                    a.0.iter()
                        .zip(&reference.0)
                        .map(|(x, y)| (x - y).abs())
                        .fold(0.0f64, f64::max)
                };
                let (a, b) = (
                    run(Equip::stages(s), h, steps),
                    run(Gauss::stages(s), h, steps),
                );
                println!(
                    "s {s} angle {angle} equip {:.2e} gauss {:.2e}",
                    e(&a),
                    e(&b)
                );
            }
        }
    }
}
