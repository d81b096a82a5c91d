//! The solution of the linearised stage equations does not depend on M.

use crate::options::step_options::Preconditioner as Wanted;
use crate::outcome::outcome::Counts;
use crate::precondition::choice::Choice;
use equip_autodiff::Hamiltonian;
use equip_iterate::{Contraction, Held, LinearIteration, Progress};
use equip_iterate::{Iterate, Preconditioner, State};
use equip_scalar::DoubleDouble;
use equip_scalar::Float;
use equip_tableau::Coefficients;

/// A stiff and a soft mode along single components; the momenta are eliminated.
fn separable() -> Hamiltonian {
    let energy = Hamiltonian::new(2, |q, p| {
        let soft = 0.5 * q[0] * q[0] + 0.1 * q[0].powi(4);
        0.5 * (p[0] * p[0] + 0.5 * p[1] * p[1]) + soft + 8.0 * q[1] * q[1] + 0.3 * q[0] * q[1].cos()
    });
    energy.unwrap()
}

/// All components unknown.
fn coupled() -> Hamiltonian {
    let energy = Hamiltonian::new(2, |q, p| {
        let kinetic = 0.5 * (p[0] * p[0] + p[1] * p[1]) / (1.5 + q[0].sin());
        kinetic + 0.2 * q[0] * p[1] + 0.5 * q[0] * q[0] + 0.7 * q[1] * q[1]
    });
    energy.unwrap()
}

/// Solves the linearised stage equations with each M and without, with either end held.
fn one_solution<T: Float>(energy: &Hamiltonian, tolerance: f64, most: f64) {
    let pattern = &energy.structure().hessian;
    let mut evaluator = energy.evaluator::<T>();
    let numbers = |x: [i64; 2]| x.map(|x| T::ratio(x, 10));
    let y = State::new(&numbers([10, 3]), &numbers([-2, 9]));
    for s in [2, 3, 6] {
        let (h, gauss) = (T::ratio(3, 10), Coefficients::<T>::gauss(s).unwrap());
        let mut iterate = Iterate::prepare(&gauss, 4, evaluator.kinetic(), &vec![T::int(0); s - 1]);
        iterate.begin(&gauss, (&y, h));
        let mut contraction = Contraction::new(iterate.is_twofold(), T::EPSILON.to_f64());
        contraction.begin(false);
        while iterate.fixed_point(&mut evaluator, &y, &mut contraction).0 == Progress::Contracts {}
        iterate.keep_momenta(&y);
        let (sides, stride) = (2, iterate.stride());
        let mut r = vec![T::int(0); 4 * sides * stride];
        for (k, row) in r.chunks_exact_mut(stride).enumerate() {
            for (i, x) in row.iter_mut().enumerate().take(s) {
                *x = T::ratio(((7 * k + i * i) % 11) as i64 - 5, 3);
            }
        }
        let mut linear = LinearIteration::new(&gauss, &iterate, pattern.to_pattern(), sides);
        assert!(linear.linearise(&iterate, &mut evaluator));
        let weights = [T::int(1); 4];
        for held in [Held::Start, Held::End] {
            let mut solve = |m: Option<&mut (dyn Preconditioner<T> + '_)>| {
                let mut x = vec![T::int(0); r.len()];
                let tolerance = (weights.as_slice(), T::exact(tolerance));
                assert!(linear.solve(held, (&r, &mut x), tolerance, &iterate, m));
                let unknown = iterate.unknowns() * stride;
                let found = x
                    .chunks_exact(4 * stride)
                    .flat_map(|x| x[..unknown].to_vec());
                linear
                    .sums()
                    .iter()
                    .copied()
                    .chain(found)
                    .collect::<Vec<_>>()
            };
            let plain = solve(None);
            for wanted in [Wanted::Diagonal, Wanted::Frozen, Wanted::Full] {
                let mut choice = Choice::new(wanted, (&gauss, &iterate), energy.structure());
                let at = (&gauss, &iterate);
                let is_made = choice.make(at, &mut evaluator, (&y, h), &mut Counts::default());
                assert!(is_made, "{wanted:?}");
                for (a, &b) in solve(choice.operator()).into_iter().zip(&plain) {
                    let off = (a - b).abs().to_f64();
                    assert!(off <= most, "s = {s}, {held:?}, {wanted:?}: {off:e}");
                }
            }
        }
    }
}

#[test]
fn a_preconditioner_changes_nothing_in_the_solution() {
    for energy in [separable(), coupled()] {
        one_solution::<f64>(&energy, 1e-14, 1e-13);
        one_solution::<DoubleDouble>(&energy, 1e-28, 1e-26);
    }
}
