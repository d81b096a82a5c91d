//! Derivatives at many points at once: every bit of the gradient at one point, whatever the instructions.
#![allow(clippy::unwrap_used)]

use crate::common::{
    Chain, ChargedParticle, DoublePendulum, Energy, HenonHeiles, Kepler, Pendulum, Pythagorean,
    Random, same_bits,
};
use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{DoubleDouble, Float, InstructionSet, Num, Scalar};

/// Equal in every bit, but for the sign of zero where `T` forces it.
fn same_number<T: Float>(a: T, b: T) -> bool {
    same_bits(a, b) || (a == T::int(0) && b == T::int(0))
}

/// All counts from 1 to 20, with the shortest stride and with a longer one.
fn batches_equal_points<T: Float>(name: &str, h: &Hamiltonian) {
    let structure = h.structure();
    let m = structure.degrees_of_freedom;
    let mut random = Random(0x1A9E5 + m as u64);
    let mut one = h.evaluator::<T>();
    for set in InstructionSet::available() {
        let mut many = h.evaluator::<T>();
        many.set_instruction_set(set);
        for count in 1..=20_usize {
            for stride in [
                count,
                count.next_multiple_of(4),
                count.next_multiple_of(8) + 3,
            ] {
                let states: Vec<T> = (0..2 * m * stride)
                    .map(|_| T::exact(random.within(0.2, 0.9)))
                    .collect();
                let mut gradients = vec![T::NAN; states.len()];
                many.gradients_by_component(&states, &mut gradients, stride, count);
                let mut forces = vec![T::NAN; m * stride];
                if structure.separable {
                    many.forces_by_component(&states[..m * stride], &mut forces, stride, count);
                }
                let entries = structure.hessian.len();
                let mut hessians = vec![T::NAN; entries * stride];
                many.hessians_by_component(&states, &mut hessians, stride, count);
                for i in 0..count {
                    let y: Vec<T> = (0..2 * m).map(|c| states[c * stride + i]).collect();
                    let mut hessian = vec![T::NAN; entries];
                    one.hessian(&y, &mut hessian);
                    for (e, &expected) in hessian.iter().enumerate() {
                        let found = hessians[e * stride + i];
                        assert!(
                            same_number(found, expected),
                            "{name} {set:?}: point {i} of {count} in {stride}, entry {e}: {found:e} {expected:e}"
                        );
                    }
                    let mut gradient = vec![T::NAN; 2 * m];
                    one.gradient(&y, &mut gradient);
                    for (c, &expected) in gradient.iter().enumerate() {
                        let found = gradients[c * stride + i];
                        assert!(
                            same_bits(found, expected),
                            "{name} {set:?}: point {i} of {count} in {stride}, component {c}: {found:e} {expected:e}"
                        );
                        if c < m && structure.separable {
                            let found = forces[c * stride + i];
                            assert!(
                                same_number(found, expected),
                                "{name} {set:?}: force {c} at point {i} of {count}: {found:e} {expected:e}"
                            );
                        }
                    }
                }
            }
        }
    }
}

fn in_both_floats(name: &str, energy: impl Energy) {
    let h = energy.hamiltonian();
    batches_equal_points::<f64>(name, &h);
    batches_equal_points::<DoubleDouble>(name, &h);
}

/// Every function an energy can be written with, U(q) and T(p) apart.
struct Functions;

impl Energy for Functions {
    fn degrees_of_freedom(&self) -> usize {
        3
    }
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        let (x, y, z) = (q[0], q[1], q[2]);
        let smooth = x.exp() + y.ln() + z.exp_m1() + x.ln_1p() + (x * y).sin() + (y * z).cos();
        let angles = (x * z).tan() + y.asin() + z.acos() + x.atan() + y.atan2(z) + x.hypot(y);
        let hyperbolic = x.sinh() + y.cosh() + (x - z).tanh() + x.pow(y) + z.powf(-1.5);
        let powers = x.powi(3) + y.powi(4) + z.powi(5) + x.powi(6) + y.powi(7) + z.powi(-2);
        let pieces = (x - y).abs() + x.min(z) + y.max(x) + (z - x).max(0.1) + x.recip();
        let kinetic = (1.0 + p[0] * p[0] + p[1] * p[1]).sqrt() + p[2].powi(2) / 3.0;
        kinetic - (smooth + angles * 0.3 + hyperbolic / (1.0 + x * y) + powers) + pieces / 7.0
    }
}

/// Every operation that machine code is made of, long sums with terms subtracted too, and more numbers alive
/// at a time than there are registers.
struct Arithmetic;

impl Energy for Arithmetic {
    fn degrees_of_freedom(&self) -> usize {
        12
    }
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        let powers = q[0].powi(3) + q[1].powi(4) - q[2].powi(5) + q[3].powi(-6) + q[4].powi(7);
        let powers = powers + q[5].powi(-1) - q[6].powi(9) + q[7].powi(1) + q[8].powi(0) * q[9];
        let others = (q[0] - q[1]).abs() + (-q[2]).recip() + 3.0 / q[3] + (q[4] / q[5]).sqrt();
        let mut pairs = q[0] * 0.0;
        for i in 0..12 {
            for j in 0..i {
                let r2 = 0.5 + (q[i] - q[j]) * (q[i] - q[j]) + q[i] * q[i];
                pairs -= (i as f64 + 1.0) / (r2 * r2.sqrt());
            }
        }
        let kinetic = p.iter().fold(p[0], |sum, &p| sum + p * p / 3.0);
        kinetic / 2.0 + powers - others * 0.25 + pairs
    }
}

#[test]
fn well_known_systems() {
    in_both_floats("Kepler", Kepler);
    in_both_floats("Hénon–Heiles", HenonHeiles);
    in_both_floats("pendulum", Pendulum);
    in_both_floats("double pendulum", DoublePendulum);
    in_both_floats("charged particle", ChargedParticle);
    in_both_floats("three bodies", Pythagorean);
}

#[test]
fn every_function() {
    in_both_floats("functions", Functions);
    in_both_floats("arithmetic", Arithmetic);
}

#[test]
fn long_chains_and_sums() {
    in_both_floats("chain", Chain(40));
    let all_with_all = Hamiltonian::new(12, |q, p| {
        let mut h: Var = p.iter().map(|p| p.powi(2)).sum::<Var>() * 0.5;
        for (i, &a) in q.iter().enumerate() {
            for &b in &q[..i] {
                h -= 1.0 / (2.0 + (a - b).powi(2)).sqrt();
            }
        }
        h
    });
    batches_equal_points::<f64>("all with all", &all_with_all.unwrap());
}

#[test]
fn supplied_gradients_are_used() {
    let h = Hamiltonian::new(1, |q, p| p[0] * p[0] / 2.0 - q[0].cos()).unwrap();
    let supplied = h.with_gradient(|q, p, dq, dp| (dq[0], dp[0]) = (10.0 + q[0], 20.0 + p[0]));
    batches_equal_points::<f64>("supplied", &supplied);
    let mut gradients = [0.0; 4];
    let mut evaluator = supplied.evaluator::<f64>();
    evaluator.gradients_by_component(&[1.0, 2.0, 3.0, 4.0], &mut gradients, 2, 2);
    assert_eq!(gradients, [11.0, 12.0, 23.0, 24.0]);
}

#[test]
#[should_panic(expected = "only if H = T(p) + U(q)")]
fn forces_of_an_inseparable_energy() {
    let h = Hamiltonian::new(1, |q, p| q[0] * p[0]).unwrap();
    h.evaluator::<f64>()
        .forces_by_component(&[1.0], &mut [0.0], 1, 1);
}

#[test]
fn kinetic_energies() {
    let coupled = Hamiltonian::new(3, |q, p| {
        let quadratic = p[0].powi(2) / 2.0 + p[1].powi(2) + p[0] * p[1] / 4.0 + 2.0 * p[2].powi(2);
        quadratic - 3.0 * p[2] + 1.0 / q[0] + (q[1] * q[2]).sin()
    })
    .unwrap();
    let kinetic = coupled.evaluator::<f64>().kinetic().unwrap();
    assert_eq!(kinetic.diagonal(), None);
    assert_eq!(kinetic.offset(), [0.0, 0.0, -3.0]);
    let rows: Vec<Vec<(usize, f64)>> = (0..3).map(|i| kinetic.row(i).collect()).collect();
    assert_eq!(
        rows,
        [
            vec![(0, 1.0), (1, 0.25)],
            vec![(0, 0.25), (1, 2.0)],
            vec![(2, 4.0)]
        ]
    );
    let mut velocity = [0.0; 3];
    kinetic.velocity(&[1.0, 2.0, 3.0], &mut velocity);
    assert_eq!(velocity, [1.5, 4.25, 9.0]);

    let kepler = Kepler.hamiltonian();
    let kinetic = kepler.evaluator::<DoubleDouble>().kinetic().unwrap();
    assert_eq!(
        kinetic.diagonal(),
        Some([DoubleDouble::int(1); 2].as_slice())
    );
    let relativistic =
        Hamiltonian::new(1, |q, p| (1.0 + p[0] * p[0]).sqrt() + q[0] * q[0]).unwrap();
    assert!(relativistic.evaluator::<f64>().kinetic().is_none());
    let coupled = Hamiltonian::new(1, |q, p| p[0] * p[0] + p[0] * q[0]).unwrap();
    assert!(coupled.evaluator::<f64>().kinetic().is_none());
}
