//! H of very many terms: by compensated summation its value is right to the rounding of the terms, not of
//! their partial sums.
#![allow(clippy::unwrap_used)]

use crate::common::{Chain, Energy, Random, widened};
use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{DoubleDouble, Float};

fn scattered(n: usize, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    (0..n).map(|_| random.within(-1.0, 1.0)).collect()
}

/// H in double-double at the same state, and the errors of H as it is and compensated, in units of the last
/// digit of H.
fn errors(energy: &Hamiltonian, y: &[f64]) -> [f64; 2] {
    let exact = energy.evaluator::<DoubleDouble>().value(&widened(y));
    let mut evaluator = energy.evaluator::<f64>();
    let mut gradient = vec![0.0; y.len()];
    let compensated = evaluator.compensated_value(y);
    let beside = evaluator.gradient_with_compensated_value(y, &mut gradient);
    assert_eq!(compensated.to_bits(), beside.to_bits());
    let mut alone = vec![0.0; y.len()];
    let plain = evaluator.gradient(y, &mut alone);
    assert_eq!(gradient, alone);
    [plain, compensated].map(|h| {
        let error = DoubleDouble::exact(h) - exact;
        error.to_f64().abs() / (f64::EPSILON * exact.to_f64().abs())
    })
}

#[test]
fn compensated_sums_are_rounded_once() {
    let m = 8192;
    let chain = Chain(m).hamiltonian();
    let mut sums = [0.0; 2];
    for seed in 1..=8 {
        let y = scattered(2 * m, seed);
        let [plain, compensated] = errors(&chain, &y);
        assert!(compensated <= 0.6, "{compensated}");
        sums = [sums[0] + plain, sums[1] + compensated];
    }
    assert!(sums[0] > 4.0 * sums[1], "not worth it: {sums:?}");
}

/// Terms with a minus, and sums within sums.
#[test]
fn differences_are_compensated_too() {
    let m = 2000;
    let y = scattered(2 * m, 7);
    let h = Hamiltonian::new(m, |q, p| {
        let kinetic = p.iter().map(|p| p.powi(2)).sum::<Var>() / 2.0;
        q.iter()
            .fold(1e4 + kinetic, |h, q| h - q.powi(3).exp() + 0.5 * q.powi(4))
    });
    let [_, compensated] = errors(&h.unwrap(), &y);
    assert!(compensated <= 1.0, "{compensated}");
}

#[test]
fn short_sums_are_as_they_are() {
    let energy = Hamiltonian::new(10, |q, p| {
        let terms = q.iter().zip(p);
        terms.fold(Var::from(0.0), |h, (&q, &p)| {
            h + 0.5 * p * p - 1.0 / (1.0 + q * q)
        })
    });
    let mut evaluator = energy.unwrap().evaluator::<f64>();
    let y = scattered(20, 7);
    let plain = evaluator.value(&y);
    assert_eq!(plain.to_bits(), evaluator.compensated_value(&y).to_bits());
}
