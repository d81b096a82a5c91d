#![allow(missing_docs)]
use equip_autodiff::*;
use equip_scalar::*;
use std::hint::black_box;
use std::time::Instant;
fn best(reps: usize, mut f: impl FnMut(), points: usize) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..40 {
        let t = Instant::now();
        for _ in 0..reps {
            f();
        }
        best = best.min(t.elapsed().as_secs_f64() / reps as f64);
    }
    best * 1e9 / points as f64
}
fn main() {
    let charged = hamiltonian!(3, |q, p| {
        let (x, y) = (p[0] + q[1] * 0.5, p[1] - q[0] * 0.5);
        (x * x + y * y + p[2] * p[2]) * 0.5 + q[2].powi(2) - 0.5 * (q[0].powi(2) + q[1].powi(2))
    })
    .unwrap();
    let kepler = hamiltonian!(2, |q, p| 0.5 * (p[0] * p[0] + p[1] * p[1])
        - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt())
    .unwrap();
    let kt = Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    })
    .unwrap();
    let ct = Hamiltonian::new(3, |q, p| {
        let (x, y) = (p[0] + q[1] * 0.5, p[1] - q[0] * 0.5);
        (x * x + y * y + p[2] * p[2]) * 0.5 + q[2].powi(2) - 0.5 * (q[0].powi(2) + q[1].powi(2))
    })
    .unwrap();
    run("charged static", &charged, 5000);
    run("charged tape", &ct, 5000);
    run("kepler static", &kepler, 5000);
    run("kepler tape", &kt, 5000);
    run("6 bodies", &bodies(6), 500);
    for m in [32, 64, 256, 512, 1024] {
        run(
            &format!("chain {m}"),
            &Hamiltonian::new(m, chain).unwrap(),
            20000 / m,
        );
    }
    let y: Vec<f64> = (0..36)
        .map(|i| (1.3 * i as f64).sin() + 0.1 * i as f64)
        .collect();
    let mut g = vec![0.0; 36];
    println!(
        "bodies by hand {:.1}",
        best(1000, || bodies_hand(black_box(&y), black_box(&mut g)), 1)
    );
    for m in [32, 64, 256, 512, 1024] {
        let y: Vec<f64> = (0..2 * m)
            .map(|i| (1.3 * i as f64).sin() + 0.1 * i as f64)
            .collect();
        let mut g = vec![0.0; 2 * m];
        println!(
            "chain {m} by hand {:.1} force {:.1}",
            best(1000, || chain_hand(black_box(&y), black_box(&mut g)), 1),
            best(
                1000,
                || chain_hand(black_box(&y[..m]), black_box(&mut g[..m])),
                1
            )
        );
    }
}
fn chain(q: &[Var], p: &[Var]) -> Var {
    let kinetic = p.iter().map(|p| p.powi(2)).sum::<Var>() * 0.5;
    let springs = q.windows(2).map(|q| {
        let stretch = q[1] - q[0];
        stretch.powi(2) * 0.5 + 0.25 * stretch.powi(4)
    });
    kinetic + springs.sum::<Var>()
}
#[inline(never)]
fn chain_hand(y: &[f64], g: &mut [f64]) {
    let m = y.len() / 2;
    let m = if m % 32 == 0 && y.len() > 0 { m } else { m };
    let (q, p) = y.split_at(m);
    let (dq, dp) = g.split_at_mut(m);
    dp.copy_from_slice(p);
    dq.fill(0.0);
    let mut last = 0.0;
    for i in 0..m - 1 {
        let s = q[i + 1] - q[i];
        let f = s + s * s * s;
        dq[i] = last - f;
        last = f;
    }
    dq[m - 1] = last;
}
#[inline(never)]
fn bodies_hand(y: &[f64], g: &mut [f64]) {
    let (q, p) = y.split_at(18);
    let (dq, dp) = g.split_at_mut(18);
    dq.fill(0.0);
    for i in 0..6 {
        let mi = 1.0 + i as f64;
        for k in 0..3 {
            dp[3 * i + k] = p[3 * i + k] / mi;
        }
        for j in 0..i {
            let mj = 1.0 + j as f64;
            let d = [
                q[3 * i] - q[3 * j],
                q[3 * i + 1] - q[3 * j + 1],
                q[3 * i + 2] - q[3 * j + 2],
            ];
            let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            let f = mi * mj / (r2 * r2.sqrt());
            for k in 0..3 {
                dq[3 * i + k] += f * d[k];
                dq[3 * j + k] -= f * d[k];
            }
        }
    }
}
fn bodies(n: usize) -> Hamiltonian {
    Hamiltonian::new(3 * n, |q, p| {
        let mut h = Var::from(0.0);
        for i in 0..n {
            let mass = 1.0 + i as f64;
            h += (0..3).map(|k| p[3 * i + k].powi(2)).sum::<Var>() / (2.0 * mass);
            for j in 0..i {
                let r2: Var = (0..3).map(|k| (q[3 * i + k] - q[3 * j + k]).powi(2)).sum();
                h -= mass * (1.0 + j as f64) / r2.sqrt();
            }
        }
        h
    })
    .unwrap()
}
fn run<H: System>(name: &str, h: &H, reps: usize) {
    let n = 2 * h.degrees_of_freedom();
    let mut e = h.evaluator::<f64>();
    for set in InstructionSet::available() {
        e.set_instruction_set(set);
        let y: Vec<f64> = (0..8 * n)
            .map(|i| 1.0 + (i as f64).sin() * 0.2 + 0.1 * (i / 8) as f64)
            .collect();
        let mut g = vec![0.0; 8 * n];
        let a = best(
            reps,
            || e.gradients_by_component(black_box(&y), black_box(&mut g), 8, 8),
            8,
        );
        let b = if h.structure().separable {
            best(
                reps,
                || e.forces_by_component(black_box(&y[..4 * n]), black_box(&mut g[..4 * n]), 8, 8),
                8,
            )
        } else {
            0.0
        };
        let b4 = if h.structure().separable {
            best(
                reps,
                || e.forces_by_component(black_box(&y[..2 * n]), black_box(&mut g[..2 * n]), 4, 4),
                4,
            )
        } else {
            0.0
        };
        let c = best(reps, || e.gradients(black_box(&y), black_box(&mut g), n), 8);
        println!(
            "{name} {set:?}: gradient {a:.2} forces {b:.2} forces in 4 lanes {b4:.2} scalar {c:.2} ns per point"
        );
    }
}
