//! Random expressions: the replayed value has every bit of the energy evaluated directly.
#![allow(clippy::unwrap_used)]

use crate::common::{Energy, PROGRAM_M as M, Program, Random, same_bits, widened};
use equip_autodiff::Hamiltonian;
use equip_scalar::DoubleDouble;

const EXPRESSIONS: usize = 400;

#[test]
fn replay_has_every_bit_of_direct_evaluation() {
    let mut random = Random(0x5eed_0002);
    let mut finite = 0;
    for _ in 0..EXPRESSIONS {
        let program = Program::new(&mut random);
        // A random program may fold its constants to NaN; that is refused, and tested elsewhere.
        let Ok(h) = Hamiltonian::new(M, |q, p| program.energy(q, p)) else {
            continue;
        };
        for _ in 0..3 {
            let y: Vec<f64> = (0..2 * M).map(|_| random.within(-2.0, 2.0)).collect();
            let replayed = h.evaluator::<f64>().value(&y);
            assert!(same_bits(replayed, program.direct(&y)), "{y:?}");
            finite += usize::from(replayed.is_finite());
            let wide = widened(&y);
            let replayed = h.evaluator::<DoubleDouble>().value(&wide);
            assert!(same_bits(replayed, program.direct(&wide)), "{y:?}");
        }
    }
    assert!(finite > EXPRESSIONS, "only {finite} finite values");
}

#[test]
fn tangents_and_gradients_agree_on_random_expressions() {
    let mut random = Random(0x5eed_0003);
    let mut compared = 0;
    for _ in 0..EXPRESSIONS {
        let program = Program::new(&mut random);
        let Ok(h) = Hamiltonian::new(M, |q, p| program.energy(q, p)) else {
            continue;
        };
        let y: Vec<f64> = (0..2 * M).map(|_| random.within(-2.0, 2.0)).collect();
        let mut evaluator = h.evaluator::<f64>();
        let pattern = &h.structure().hessian;
        let mut entries = vec![0.0; pattern.len()];
        evaluator.hessian(&y, &mut entries);
        let v: Vec<f64> = (0..2 * M).map(|_| random.within(-1.0, 1.0)).collect();
        let mut product = vec![0.0; 2 * M];
        evaluator.hessian_vector(&y, &v, &mut product);
        let size = entries.iter().fold(1e-3_f64, |a, b| a.max(b.abs()));
        if !(entries.iter().chain(&product).all(|x| x.is_finite()) && size < 1e6) {
            continue;
        }
        for (i, found) in product.iter().enumerate() {
            let expected: f64 = pattern.row(i).map(|(entry, j)| entries[entry] * v[j]).sum();
            assert!(
                (found - expected).abs() < 1e-10 * size,
                "{found:e} {expected:e}"
            );
        }
        compared += 1;
    }
    assert!(
        compared > EXPRESSIONS / 4,
        "only {compared} expressions compared"
    );
}
