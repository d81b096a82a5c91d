//! Half-integer powers: roots, with the value of direct evaluation and the derivatives of powers.
#![allow(clippy::unwrap_used)]

use crate::common::{Energy, Random, same_bits, widened};
use equip_autodiff::Hamiltonian;
use equip_scalar::{Constant, DoubleDouble, Float, Num, Scalar, decimal, ratio};

/// (q₀² + q₁²)^c + ½p² and more of the same root.
struct Power(Constant);

impl Energy for Power {
    fn degrees_of_freedom(&self) -> usize {
        2
    }
    fn energy<S: Scalar>(&self, q: &[Num<S>], p: &[Num<S>]) -> Num<S> {
        let r2 = q[0] * q[0] + q[1] * q[1];
        0.5 * (p[0] * p[0] + p[1] * p[1]) + r2.powf(self.0) * q[0] - r2.sqrt()
    }
}

fn as_written<T: Float>(c: Constant) {
    let mut evaluator = Power(c).hamiltonian().evaluator::<T>();
    let mut random = Random(0x5eed_0021);
    for _ in 0..32 {
        let y: Vec<T> = (0..4).map(|_| T::exact(random.within(-2.0, 2.0))).collect();
        let direct = Power(c).direct(&y);
        let mut gradient = y.clone();
        let values = [evaluator.value(&y), evaluator.gradient(&y, &mut gradient)];
        assert!(
            values.into_iter().all(|x| same_bits(x, direct)),
            "{c:?}: {values:?} {direct}"
        );
        // ∂H/∂q₀ = 2 c q₀² r2^(c−1) + r2^c − q₀/√r2.
        let r2 = y[0] * y[0] + y[1] * y[1];
        let exponent: T = c.to();
        let power = |less: i64| <T as Scalar>::pow(r2, exponent - T::int(less));
        let first = T::int(2) * exponent * y[0] * y[0] * power(1);
        let parts = [first, power(0), -(y[0] / <T as Scalar>::sqrt(r2))];
        let sum = parts.iter().fold(T::int(0), |sum, &x| sum + x);
        let size = parts.iter().fold(T::int(0), |sum, &x| sum + x.abs());
        let error = (gradient[0] - sum).abs() / (size * T::EPSILON);
        assert!(error < T::int(32), "{c:?}: {error}");
        // Many points at once.
        let states: Vec<T> = y.iter().flat_map(|&x| [x; 8]).collect();
        let mut gradients = states.clone();
        evaluator.gradients_by_component(&states, &mut gradients, 8, 8);
        let of_point: Vec<T> = gradients.chunks(8).map(|row| row[3]).collect();
        assert_eq!(of_point, gradient);
    }
}

#[test]
fn values_are_those_of_direct_evaluation() {
    for n in (-15..=15).filter(|n| n % 2 != 0) {
        for c in [ratio(n, 2), Constant::double(n as f64 / 2.0)] {
            as_written::<f64>(c);
            as_written::<DoubleDouble>(c);
        }
    }
    for c in [
        decimal("1.5").unwrap(),
        decimal("-2.5").unwrap(),
        ratio(1, 3),
    ] {
        as_written::<f64>(c);
        as_written::<DoubleDouble>(c);
    }
}

/// Spheres that do not touch exert no force: it is 0, not NaN.
#[test]
fn contacts_open_smoothly() {
    let h = Hamiltonian::new(1, |q, p| 0.5 * p[0].powi(2) + q[0].max(0.0).powf(2.5)).unwrap();
    let mut evaluator = h.evaluator::<f64>();
    let mut gradient = [f64::NAN; 2];
    for (q, force, stiffness) in [(0.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (4.0, 20.0, 7.5)] {
        evaluator.gradient(&[q, 1.0], &mut gradient);
        assert_eq!(gradient, [force, 1.0]);
        evaluator.gradient_with_bound(&[q, 1.0], &mut gradient);
        assert_eq!(gradient, [force, 1.0]);
        evaluator.hessian_vector(&[q, 1.0], &[1.0, 0.0], &mut gradient);
        assert_eq!(gradient, [stiffness, 0.0]);
        let mut slopes = [f64::NAN; 16];
        let states = [[q; 8], [1.0; 8]].concat();
        evaluator.gradients_by_component(&states, &mut slopes, 8, 8);
        assert_eq!((slopes[3], slopes[11]), (force, 1.0));
    }
}

/// Hessians against differences of gradients in double-double.
#[test]
fn second_derivatives() {
    for n in [-7, -3, -1, 1, 3, 5, 9] {
        let mut evaluator = Power(ratio(n, 2)).hamiltonian().evaluator::<DoubleDouble>();
        let y = widened(&[0.8, -0.5, 0.3, 0.2]);
        let (mut product, mut above, mut below) = (y.clone(), y.clone(), y.clone());
        let v: Vec<DoubleDouble> = widened(&[1.0, 0.5, 0.0, 0.0]);
        evaluator.hessian_vector(&y, &v, &mut product);
        let step = DoubleDouble::exact(1e-10);
        let at = |sign: DoubleDouble| -> Vec<DoubleDouble> {
            y.iter()
                .zip(&v)
                .map(|(&y, &v)| y + sign * step * v)
                .collect()
        };
        evaluator.gradient(&at(DoubleDouble::int(1)), &mut above);
        evaluator.gradient(&at(DoubleDouble::int(-1)), &mut below);
        for k in 0..2 {
            let expected = (above[k] - below[k]) / (step + step);
            let error = ((product[k] - expected) / expected).abs().to_f64();
            assert!(error < 1e-15, "{n}: {error}");
        }
    }
}

/// As cheap as what is written with roots.
#[test]
fn no_more_operations_than_roots() {
    let count = |energy: fn(equip_autodiff::Var) -> equip_autodiff::Var| {
        let h = Hamiltonian::new(2, |q, _| energy(q[0] * q[0] + q[1] * q[1])).unwrap();
        (h.operations(), h.gradient_operations())
    };
    assert_eq!(count(|x| x.powf(-0.5)), count(|x| 1.0 / x.sqrt()));
    assert_eq!(count(|x| x.powf(0.5)), count(|x| x.sqrt()));
    assert!(count(|x| x.powf(-1.5)).1 <= count(|x| 1.0 / (x * x.sqrt())).1);
}
