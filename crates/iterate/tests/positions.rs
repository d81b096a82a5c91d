//! The linearised equations of H = T(p) + U(q), iterated for the positions alone.
#![allow(clippy::unwrap_used)] // Helpers outside the test functions fail by panicking too.

use equip_autodiff::Hamiltonian;
use equip_iterate::{Contraction, Held, Iterate, LinearIteration, Progress, State};
use equip_scalar::{DoubleDouble, Float};
use equip_tableau::Coefficients;

/// The sums, and X where it is made, of all components and of the positions alone, in doubles and wider.
#[test]
fn momenta_put_in_change_nothing() {
    alone_and_together::<f64>(1e-14, 1e-13);
    alone_and_together::<DoubleDouble>(1e-28, 1e-26);
}

fn alone_and_together<T: Float>(tolerance: f64, most: f64) {
    let energy = Hamiltonian::new(2, |q, p| {
        let r = (q[0] * q[0] + 2.0 * q[1] * q[1]).sqrt();
        0.5 * (p[0] * p[0] + 0.25 * p[1] * p[1]) + p[1] - 1.0 / r
    });
    let energy = energy.unwrap();
    let pattern = &energy.structure().hessian;
    let mut evaluator = energy.evaluator::<T>();
    let numbers = |x: [i64; 2]| x.map(|x| T::ratio(x, 10));
    let y = State::new(&numbers([10, 3]), &numbers([-2, 9]));
    for s in [2, 3, 4, 8, 11, 16, 20] {
        let (h, gauss) = (T::ratio(4, 10), Coefficients::<T>::gauss(s).unwrap());
        let alphas = vec![T::int(0); s - 1];
        let mut iterate = Iterate::prepare(&gauss, 4, evaluator.kinetic(), &alphas);
        iterate.begin(&gauss, (&y, h));
        let mut contraction = Contraction::new(iterate.is_twofold(), T::EPSILON.to_f64());
        contraction.begin(false);
        while iterate.fixed_point(&mut evaluator, &y, &mut contraction).0 == Progress::Contracts {}
        iterate.keep_momenta(&y);
        let whole = Iterate::prepare(&gauss, 4, None, &alphas);
        let (sides, stride) = (3, iterate.stride());
        let mut r = vec![T::int(0); 4 * sides * stride];
        for (k, row) in r.chunks_exact_mut(stride).enumerate() {
            for (i, x) in row.iter_mut().enumerate().take(s) {
                *x = T::ratio(((7 * k + i * i) % 11) as i64 - 5, 3);
            }
        }
        let mut both = [&whole, &iterate].map(|of| {
            let mut linear = LinearIteration::new(&gauss, of, pattern.to_pattern(), sides);
            assert!(linear.linearise(&iterate, &mut evaluator));
            linear
        });
        assert!(!both[0].knows_momenta() && both[1].knows_momenta());
        for held in [Held::Start, Held::End] {
            let [together, alone] = both.each_mut().map(|linear| {
                let mut x = vec![T::int(0); r.len()];
                let weights = (vec![T::int(1); 4], T::exact(tolerance));
                let sides = (r.as_slice(), x.as_mut_slice());
                assert!(linear.solve(held, sides, (&weights.0, weights.1), &iterate, None));
                let found = x
                    .chunks_exact(4 * stride)
                    .flat_map(|x| x[..2 * stride].to_vec());
                linear
                    .sums()
                    .iter()
                    .copied()
                    .chain(found)
                    .collect::<Vec<_>>()
            });
            assert_eq!(together.len(), alone.len());
            for (a, b) in together.into_iter().zip(alone) {
                let off = (a - b).abs().to_f64();
                assert!(off <= most, "s = {s}, {held:?}: {off:e}");
            }
        }
    }
}
