//! Cost of ∇H and ∇²H: by hand, by dual numbers, by the tape; and how it grows with the length of a chain.
#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use equip_autodiff::{Energy, Evaluate, Hamiltonian, System, Var, hamiltonian};
use equip_scalar::{Float, InstructionSet, Num, Scalar, mix_stages};
use std::hint::black_box;

struct Kepler {
    by_hand: bool,
}

impl Energy for Kepler {
    fn degrees_of_freedom(&self) -> usize {
        2
    }
    #[inline(always)]
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - 1.0 / (q[0] * q[0] + q[1] * q[1]).sqrt()
    }
    #[inline(always)]
    fn gradient<T: Float>(&self, q: &[T], p: &[T], dq: &mut [T], dp: &mut [T]) -> bool {
        if self.by_hand {
            let r2 = q[0] * q[0] + q[1] * q[1];
            let factor = T::int(1) / (r2 * <T as Scalar>::sqrt(r2));
            (dq[0], dq[1], dp[0], dp[1]) = (q[0] * factor, q[1] * factor, p[0], p[1]);
        }
        self.by_hand
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

fn time<H: System>(c: &mut Criterion, group: &str, name: impl ToString, h: &H, hessian: bool) {
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
    let by_hand = Hamiltonian::from_energy(Kepler { by_hand: true }).unwrap();
    let dual = Hamiltonian::from_energy(Kepler { by_hand: false }).unwrap();
    let mu = 1.0;
    let written = hamiltonian!(2; mu; |q, p| {
        0.5 * (p[0] * p[0] + p[1] * p[1]) - mu / (q[0] * q[0] + q[1] * q[1]).sqrt()
    })
    .unwrap();
    let tape = Hamiltonian::new(2, |q, p| Kepler { by_hand: false }.energy(q, p)).unwrap();
    time(c, "kepler/gradient", "by hand", &by_hand, false);
    time(c, "kepler/gradient", "dual", &dual, false);
    time(c, "kepler/gradient", "macro", &written, false);
    time(c, "kepler/gradient", "tape", &tape, false);
    time(c, "kepler/hessian", "dual", &dual, true);
    time(c, "kepler/hessian", "tape", &tape, true);
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
fn lanes_of<H: System>(c: &mut Criterion, name: &str, h: &H) {
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
    let dual = Hamiltonian::from_energy(Kepler { by_hand: false }).unwrap();
    let tape = Hamiltonian::new(2, |q, p| Kepler { by_hand: false }.energy(q, p)).unwrap();
    lanes_of(c, "kepler/dual", &dual);
    lanes_of(c, "kepler/tape", &tape);
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
