//! Large recordings: what time and memory they take grows with their operations, and with nothing else.
#![allow(clippy::unwrap_used)]

use crate::allocations::peak;
use equip_autodiff::{BuildError, Hamiltonian, Var};
use equip_scalar::Float;
use std::time::{Duration, Instant};

const MEGABYTE: usize = 1 << 20;

/// 1/(… + p): every operation waits for the one before.
fn nested(operations: usize) -> Hamiltonian {
    Hamiltonian::new(1, |q, p| {
        (0..operations / 2).fold(q[0], |x, _| 1.0 / (x + p[0]))
    })
    .unwrap()
}

/// n bodies in three dimensions, all attracted by all.
fn bodies(n: usize) -> Hamiltonian {
    let h = Hamiltonian::new(3 * n, |q, p| {
        let mut h = p.iter().map(|p| p.powi(2)).sum::<Var>() / 2.0;
        for i in 0..n {
            for j in 0..i {
                let r2: Var = (0..3).map(|k| (q[3 * i + k] - q[3 * j + k]).powi(2)).sum();
                h -= 1.0 / (1.0 + r2).sqrt();
            }
        }
        h
    });
    h.unwrap()
}

#[test]
fn a_million_operations() {
    let (h, of_new) = peak(|| nested(1_000_000));
    assert_eq!(h.operations(), 1_000_000);
    let mut evaluator = h.evaluator::<f64>();
    let mut gradient = [0.0; 2];
    let (_, of_gradient) = peak(|| evaluator.gradient(&[1.0, 1.0], &mut gradient));
    // Measured: 84 and 247 MB.
    // The golden section.
    let h = evaluator.value(&[1.0, 1.0]);
    assert!((h * h + h - 1.0).abs() < 1e-15);
    // x = 1/(x + p) far down: ∂x/∂p = −x²/(1 + x²).
    let expected = -h * h / (1.0 + h * h);
    assert!(gradient[0].abs() < 1e-15 && (gradient[1] / expected - 1.0).abs() < 1e-14);
    assert!(of_new < 300 * MEGABYTE, "{of_new}");
    assert!(of_gradient < 1024 * MEGABYTE, "{of_gradient}");
}

/// Of m = 2000 degrees of freedom, the 4·10⁶ entries of ∇²H are not looked for.
#[test]
fn bodies_are_recorded_in_linear_time() {
    let seconds = |n: usize| {
        let start = Instant::now();
        let (h, bytes) = peak(|| bodies(n));
        assert!(h.structure().separable && h.structure().hessian.dimension() == 6 * n);
        (start.elapsed(), bytes, h)
    };
    let (one, of_one, _) = seconds(334);
    let (mut two, of_two, h) = seconds(667);
    // The machine may have other things to do.
    for _ in 0..3 {
        if two > 8 * one {
            two = two.min(seconds(667).0);
        }
    }
    // Four times the pairs.
    assert!(two < 8 * one + Duration::from_secs(1), "{one:?} {two:?}");
    assert!(of_two < 5 * of_one, "{of_one} {of_two}");
    let kinetic = h.evaluator::<f64>().kinetic().unwrap();
    assert!(kinetic.diagonal().unwrap().iter().all(|&w| w == 1.0));
}

/// The entries of ∇²H of two clusters that do not meet, each dense: found where they are asked for.
#[test]
fn dense_blocks_are_found_quickly() {
    let m = 600;
    let h = Hamiltonian::new(m, |q, p| {
        let square = |x: &[Var]| x.iter().copied().sum::<Var>().powi(4);
        square(&q[..m / 2]) + square(&q[m / 2..]) + p.iter().map(|p| p.powi(2)).sum::<Var>()
    });
    let h = h.unwrap();
    let start = Instant::now();
    assert_eq!(h.structure().hessian.len(), m * m / 2 + m);
    // The square of each sum, and twelve of it.
    assert_eq!(h.hessian_operations(), 602);
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{:?}",
        start.elapsed()
    );
}

/// All columns but one meet all columns but one other: no row is full.
#[test]
fn rows_that_are_nearly_full() {
    let m = 400;
    let h = Hamiltonian::new(m, |q, _| {
        let mut h = Var::from(0.0);
        for i in 0..m {
            for j in (0..i).filter(|j| i / 2 != j / 2) {
                h += q[i].powi(2) * q[j].powi(2);
            }
        }
        h
    });
    let h = h.unwrap();
    let pattern = &h.structure().hessian;
    assert_eq!(pattern.len(), m * (m - 1));
    let y: Vec<f64> = (0..2 * m).map(|i| 1.0 + (i as f64).sin() / 4.0).collect();
    let mut hessian = vec![0.0; pattern.len()];
    h.evaluator::<f64>().hessian(&y, &mut hessian);
    for i in 0..m {
        for (entry, j) in pattern.row(i) {
            let others = (0..m).filter(|k| k / 2 != i / 2).map(|k| y[k] * y[k]);
            let expected = if i == j {
                2.0 * others.sum::<f64>()
            } else {
                4.0 * y[i] * y[j]
            };
            assert!((hessian[entry] - expected).abs() < 1e-12 * expected);
        }
    }
}

#[test]
fn more_degrees_of_freedom_than_places() {
    let start = Instant::now();
    for m in [(1 << 29) + 1, 1 << 31, 1 << 40, usize::MAX / 2, usize::MAX] {
        let built = Hamiltonian::new(m, |q, _| q[0]);
        assert!(
            matches!(built, Err(BuildError::TooManyDegreesOfFreedom { m: found }) if found == m)
        );
    }
    assert!(start.elapsed() < Duration::from_secs(1));
}

/// A power for each of many exponents.
#[test]
fn many_exponents() {
    let start = Instant::now();
    let m = 50_000;
    let h = Hamiltonian::new(m, |q, _| {
        let powers = q
            .iter()
            .enumerate()
            .map(|(i, q)| q.powf(1.0 + i as f64 / 3e5));
        powers.sum::<Var>()
    });
    let y = vec![1.0; 2 * m];
    assert_eq!(h.unwrap().evaluator::<f64>().value(&y), f64::int(m as i64));
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{:?}",
        start.elapsed()
    );
}
