//! Cost of ∇H and ∇²H: by hand and from the trace of H; and how it grows with the length of a chain.
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{InstructionSet, mix_stages};
use std::hint::black_box;

fn recorded_kepler() -> Hamiltonian {
    Hamiltonian::new(2, |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    })
    .unwrap()
}

fn kepler_by_hand(q: &[f64], p: &[f64], dq: &mut [f64], dp: &mut [f64]) {
    let r2 = q[0] * q[0] + q[1] * q[1];
    let factor = 1.0 / (r2 * r2.sqrt());
    (dq[0], dq[1], dp[0], dp[1]) = (q[0] * factor, q[1] * factor, p[0], p[1]);
}

fn chain(q: &[Var], p: &[Var]) -> Var {
    let kinetic = p.iter().map(|p| p.powi(2)).sum::<Var>() * 0.5;
    let springs = q.windows(2).map(|q| {
        let stretch = q[1] - q[0];
        stretch.powi(2) * 0.5 + 0.25 * stretch.powi(4)
    });
    kinetic + springs.sum::<Var>()
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

fn state(n: usize) -> Vec<f64> {
    (0..n)
        .map(|i| (1.3 * i as f64).sin() + 0.1 * i as f64)
        .collect()
}

fn time(c: &mut Criterion, group: &str, name: impl ToString, h: &Hamiltonian, hessian: bool) {
    let n = 2 * h.degrees_of_freedom();
    let (y, mut gradient) = (state(n), vec![0.0; n]);
    let mut entries = vec![0.0; h.structure().hessian.len()];
    let mut evaluator = h.evaluator::<f64>();
    let mut group = c.benchmark_group(group);
    group.throughput(Throughput::Elements(n as u64));
    group.bench_function(BenchmarkId::from_parameter(name.to_string()), |b| {
        b.iter(|| {
            if hessian {
                evaluator.hessian(black_box(&y), &mut entries);
                black_box(&entries);
            } else {
                evaluator.gradients(black_box(&y), &mut gradient, n);
                black_box(&gradient);
            }
        });
    });
    group.finish();
}

fn kepler(c: &mut Criterion) {
    let trace = recorded_kepler();
    let by_hand = trace.clone().with_gradient(kepler_by_hand);
    time(c, "kepler/gradient", "by hand", &by_hand, false);
    time(c, "kepler/gradient", "trace", &trace, false);
    time(c, "kepler/hessian", "trace", &trace, true);
}

fn growth(c: &mut Criterion) {
    for m in [16, 64, 256, 1024, 10_000] {
        let h = Hamiltonian::new(m, chain).unwrap();
        time(c, "chain/gradient", m, &h, false);
        time(c, "chain/hessian", m, &h, true);
        c.bench_function(&format!("chain/record/{m}"), |b| {
            b.iter(|| Hamiltonian::new(black_box(m), chain).unwrap());
        });
    }
}

fn many_bodies(c: &mut Criterion) {
    let h = bodies(6);
    time(c, "bodies/gradient", 6, &h, false);
    time(c, "bodies/hessian", 6, &h, true);
}

/// ∇H, and ∇U, at eight points, with each set of instructions; times are for all eight.
fn lanes_of(c: &mut Criterion, name: &str, h: &Hamiltonian) {
    let n = 2 * h.degrees_of_freedom();
    let (y, mut gradient) = (state(8 * n), vec![0.0; 8 * n]);
    let mut evaluator = h.evaluator::<f64>();
    let mut group = c.benchmark_group(format!("lanes/{name}"));
    for set in InstructionSet::available() {
        evaluator.set_instruction_set(set);
        group.bench_function(format!("gradient/{set:?}"), |b| {
            b.iter(|| evaluator.gradients_by_component(black_box(&y), &mut gradient, 8, 8));
        });
        let half = 4 * n;
        group.bench_function(format!("forces/{set:?}"), |b| {
            b.iter(|| {
                evaluator.forces_by_component(black_box(&y[..half]), &mut gradient[..half], 8, 8);
            });
        });
    }
    group.finish();
}

fn lanes(c: &mut Criterion) {
    let trace = recorded_kepler();
    lanes_of(
        c,
        "kepler/by hand",
        &trace.clone().with_gradient(kepler_by_hand),
    );
    lanes_of(c, "kepler/trace", &trace);
    lanes_of(c, "bodies/6", &bodies(6));
    for m in [64, 256, 1024] {
        lanes_of(
            c,
            &format!("chain/{m}"),
            &Hamiltonian::new(m, chain).unwrap(),
        );
    }
    let (k, l, mut z) = (state(64), state(32), state(32));
    for set in InstructionSet::available() {
        c.bench_function(&format!("lanes/mix 8 stages/{set:?}"), |b| {
            b.iter(|| mix_stages(set, black_box(&k), black_box(&l), &mut z, 8, 8));
        });
    }
}

/// What lanes are compared with.
fn by_hand(c: &mut Criterion) {
    for m in [64, 256, 1024] {
        let (y, mut gradient) = (state(2 * m), vec![0.0; 2 * m]);
        c.bench_function(&format!("chain/by hand/{m}"), |b| {
            b.iter(|| {
                let (q, p) = black_box(&y).split_at(m);
                let (dq, dp) = gradient.split_at_mut(m);
                dp.copy_from_slice(p);
                let mut left = 0.0;
                for i in 0..m - 1 {
                    let stretch = q[i + 1] - q[i];
                    let right = stretch + stretch * stretch * stretch;
                    dq[i] = left - right;
                    left = right;
                }
                dq[m - 1] = left;
                black_box(&gradient);
            });
        });
    }
    let (y, mut gradient) = (state(36), vec![0.0; 36]);
    c.bench_function("bodies/by hand/6", |b| {
        b.iter(|| {
            let (q, p) = black_box(&y).split_at(18);
            let (dq, dp) = gradient.split_at_mut(18);
            dq.fill(0.0);
            for i in 0..6 {
                let mass = 1.0 + i as f64;
                (0..3).for_each(|k| dp[3 * i + k] = p[3 * i + k] / mass);
                for j in 0..i {
                    let d: [f64; 3] = std::array::from_fn(|k| q[3 * i + k] - q[3 * j + k]);
                    let r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                    let factor = mass * (1.0 + j as f64) / (r2 * r2.sqrt());
                    for k in 0..3 {
                        dq[3 * i + k] += factor * d[k];
                        dq[3 * j + k] -= factor * d[k];
                    }
                }
            }
            black_box(&gradient);
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_millis(1000))
        .sample_size(30);
    targets = kepler, growth, many_bodies, lanes, by_hand
}
criterion_main!(benches);
