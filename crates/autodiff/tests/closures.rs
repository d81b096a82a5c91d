//! Energies as users write them.

use equip_autodiff::{Hamiltonian, Var};
use equip_scalar::{DoubleDouble, Float, decimal, ratio};

#[test]
fn captured_parameters() {
    let (mass, stiffness) = (2.0, 3.0);
    let third = ratio(1, 3);
    let tenth = decimal("0.1").unwrap();
    let h = Hamiltonian::new(1, |q, p| {
        p[0].powi(2) / (2.0 * mass) + 0.5 * stiffness * q[0].powi(2) + third * q[0].powi(3) + tenth
    })
    .unwrap();
    let mut evaluator = h.evaluator::<f64>();
    let mut gradient = [0.0; 2];
    let value = evaluator.gradient(&[2.0, 4.0], &mut gradient);
    assert_eq!(value, 16.0 / 4.0 + 1.5 * 4.0 + (1.0 / 3.0) * 8.0 + 0.1);
    assert_eq!(gradient, [3.0 * 2.0 + 3.0 * (1.0 / 3.0) * 4.0, 4.0 / 2.0]);
    assert_eq!(h.structure().degree, Some(3));
}

#[test]
fn constants_keep_their_digits() {
    let (third, tenth) = (DoubleDouble::ratio(1, 3), decimal("0.1").unwrap());
    let h = Hamiltonian::new(1, |q, p| third * q[0] + tenth * p[0]).unwrap();
    let (three, ten) = (DoubleDouble::from(3.0), DoubleDouble::from(10.0));
    let mut gradient = [DoubleDouble::ZERO; 2];
    let value = h.evaluator().gradient(&[three, ten], &mut gradient);
    // 2 units in the last of 31 digits; with 1/3 or 1/10 as a double the error would be 2e-17.
    let allowed = DoubleDouble::EPSILON + DoubleDouble::EPSILON;
    assert!(
        (value - DoubleDouble::from(2.0)).abs() <= allowed,
        "{value}"
    );
    assert_eq!(gradient, [third, DoubleDouble::ratio(1, 10)]);
    let capped = Hamiltonian::new(1, |q, _| 0.1 * q[0]).unwrap();
    let error = (capped.evaluator().value(&[ten; 2]) - DoubleDouble::ONE).hi();
    assert!(error > 5e-17, "the literal 0.1 is the double: {error:e}");
}

#[test]
fn a_loop_over_particles() {
    let masses = [3.0, 4.0, 5.0];
    let h = Hamiltonian::new(6, |q, p| {
        let mut h = Var::from(0.0);
        for (i, &m) in masses.iter().enumerate() {
            h += (p[2 * i].powi(2) + p[2 * i + 1].powi(2)) / (2.0 * m);
            for j in 0..i {
                let (x, y) = (q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]);
                h -= m * masses[j] / x.hypot(y);
            }
        }
        h
    })
    .unwrap();
    assert!(h.structure().separable);
    assert_eq!(h.structure().degree_in_p, Some(2));
    let y = [
        1.0, 3.0, -2.0, -1.0, 1.0, -1.0, 0.1, 0.2, -0.3, 0.1, 0.2, -0.3,
    ];
    let mut gradient = [0.0; 12];
    h.evaluator::<f64>().gradient(&y, &mut gradient);
    let total: f64 = gradient[..6].iter().sum();
    assert!(total.abs() < 1e-15, "forces add up to zero: {total:e}");
    assert_eq!(gradient[6], 0.1 / 3.0);
}

#[test]
fn elementary_functions() {
    let h = Hamiltonian::new(1, |q, p| (q[0].sin() * p[0].exp()).powf(1.5)).unwrap();
    let (q, p) = (0.7_f64, 0.3_f64);
    let mut gradient = [0.0; 2];
    let value = h.evaluator::<f64>().gradient(&[q, p], &mut gradient);
    let x = q.sin() * p.exp();
    assert_eq!(value, x * x.sqrt());
    assert!((gradient[0] / (1.5 * value / q.tan()) - 1.0).abs() < 4.0 * f64::EPSILON);
    assert!((gradient[1] / (1.5 * value) - 1.0).abs() < 4.0 * f64::EPSILON);
}

#[test]
fn a_constant_energy() {
    let h = Hamiltonian::new(2, |_, _| Var::from(1.0)).unwrap();
    let mut evaluator = h.evaluator::<f64>();
    let mut gradient = [1.0; 4];
    assert_eq!(
        evaluator.gradient(&[1.0, 2.0, 3.0, 4.0], &mut gradient),
        1.0
    );
    assert_eq!(gradient, [0.0; 4]);
    let mut product = [1.0; 4];
    evaluator.hessian_vector(&[1.0; 4], &[1.0; 4], &mut product);
    assert_eq!(product, [0.0; 4]);
    evaluator.hessian(&[1.0; 4], &mut []);
    assert_eq!(
        (h.structure().degree, h.hessian_operations(), h.operations()),
        (Some(0), 0, 0)
    );
    assert!(h.structure().separable && h.structure().hessian.is_empty());
}

#[test]
fn a_single_variable() {
    let h = Hamiltonian::new(2, |_, p| p[1]).unwrap();
    let mut gradient = [1.0; 4];
    assert_eq!(
        h.evaluator::<f64>()
            .gradient(&[1.0, 2.0, 3.0, 4.0], &mut gradient),
        4.0
    );
    assert_eq!(gradient, [0.0, 0.0, 0.0, 1.0]);
    assert_eq!(
        (h.structure().degree, h.structure().degree_in_q),
        (Some(1), Some(0))
    );
}
