//! Operations that are exact add nothing to the running error bounds of H and of its gradient.
#![allow(clippy::unwrap_used)]

use crate::common::{Energy, PROGRAM_M, Program, Random, widened};
use equip_autodiff::{Evaluator, Hamiltonian, Var};
use equip_scalar::{Float, ratio};

/// What the evaluators say of H and of a multiple of it, written as a change of it that is not rounded.
fn is_a_multiple<T: Float>(h: &Hamiltonian, other: &Hamiltonian, factor: f64, y: &[T]) {
    let (mut own, mut of_other) = (h.evaluator::<T>(), other.evaluator::<T>());
    let of = |evaluator: &mut Evaluator<T>| {
        let mut all = vec![T::int(0); 2 * y.len()];
        let (slopes, rounding) = all.split_at_mut(y.len());
        let (value, bound) = evaluator.gradient_with_bound(y, slopes);
        evaluator.gradient_rounding(y, rounding);
        let (mut multiples, mut sizes) = (vec![value], vec![bound]);
        multiples.extend_from_slice(slopes);
        sizes.extend_from_slice(rounding);
        (multiples, sizes)
    };
    let (expected, sizes) = of(&mut own);
    let (multiples, sizes_of_other) = of(&mut of_other);
    let factor = T::exact(factor);
    let is_nan = |a: T, b: T| Float::is_nan(a) && Float::is_nan(b);
    for (&a, b) in expected.iter().zip(multiples) {
        // The sign of zero is none of the motion.
        let a = factor * a;
        assert!(a == b || is_nan(a, b), "{a:?} and {b:?} of {factor:?} H");
    }
    // Terms of the bound are gathered by the derivatives that they share, which −H need not: its sum is that
    // of H but for its own rounding.
    for (&a, b) in sizes.iter().zip(sizes_of_other) {
        let a = factor.abs() * a;
        let is_near = (a - b).abs() <= T::int(16) * T::EPSILON * a;
        assert!(is_near || is_nan(a, b), "{a:?} and {b:?} of {factor:?} H");
    }
}

type Change = fn(Var) -> Var;

/// The same H with another sign or in another unit.
const MULTIPLES: [(f64, Change); 7] = [
    (-1.0, |h| -h),
    (-1.0, |h| 0.0 - h),
    (-1.0, |h| h * (Var::from(0.5) * -2.0)),
    (0.25, |h| 0.25 * h),
    (-8.0, |h| h / -0.125),
    (2.0, |h| h + h),
    (4.0, |h| -(h * ratio(-8, 2))),
];
/// With choices that choose H. Its derivatives are summed in another order.
const CHOICES: [Change; 3] = [
    |h| (h + 0.0).abs().max(h.abs()) * h.signum(),
    |h| h.min(h + 0.0),
    |h| (h * h).select(h, -h),
];

#[test]
fn exact_operations_add_nothing_to_the_bounds() {
    let mut random = Random(0x5eed_0015);
    let mut compared = 0;
    for _ in 0..60 {
        let program = Program::new(&mut random);
        let moderate = |x: f64| x == 0.0 || (1e-100..1e100).contains(&x.abs());
        let Ok(h) = Hamiltonian::new(PROGRAM_M, |q, p| program.energy(q, p)) else {
            continue;
        };
        let y: Vec<f64> = (0..6).map(|_| random.within(-2.0, 2.0)).collect();
        let mut slopes = vec![0.0; 6];
        let (value, bound) = h.evaluator().gradient_with_bound(&y, &mut slopes);
        if value * bound == 0.0 || ![value, bound].iter().chain(&slopes).all(|&x| moderate(x)) {
            continue;
        }
        let changed = |change: Change| {
            Hamiltonian::new(PROGRAM_M, |q, p| change(program.energy(q, p))).unwrap()
        };
        for (factor, change) in MULTIPLES {
            is_a_multiple(&h, &changed(change), factor, &y);
            is_a_multiple(&h, &changed(change), factor, &widened(&y));
        }
        for change in CHOICES {
            let (same, other) = (changed(change).evaluator()).gradient_with_bound(&y, &mut slopes);
            assert_eq!(same, value);
            assert!((other / bound - 1.0).abs() < 1e-13, "{other:e} {bound:e}");
        }
        compared += 1;
    }
    assert!(compared > 20, "{compared}");
}
