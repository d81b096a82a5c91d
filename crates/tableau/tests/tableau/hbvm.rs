//! HBVM(k, s) beside Gauss, and what it is for: keeping a polynomial energy.

use crate::common::within;
use equip_scalar::Float;
use equip_tableau::conditions::{
    b_residual, c_residual, symmetry_residual, symplecticity_residual,
};
use equip_tableau::{Coefficients, Tableau, TableauError};

crate::common::in_every_float!(
    hbvm_with_as_many_nodes_is_gauss,
    it_is_symmetric_and_collocates_but_is_not_symplectic,
    one_degree_is_the_averaged_vector_field,
    a_quartic_energy_is_kept_from_twice_as_many_nodes_on,
);

fn hbvm_with_as_many_nodes_is_gauss<T: Float>() {
    let mut worst = T::int(0);
    for s in 1..=20 {
        let gauss = Coefficients::<T>::gauss(s)
            .unwrap()
            .tableau(&vec![T::int(0); s - 1]);
        let method = hbvm::<T>(s, s);
        assert_eq!((&method.b, &method.c), (&gauss.b, &gauss.c));
        for (x, y) in method.a.into_iter().zip(gauss.a) {
            worst = worst.max((x - y).abs());
        }
    }
    // 0.44 in f64, 0.25 in double-double, × 2.
    within("HBVM(s, s) - Gauss", worst, 0.9);
}

fn it_is_symmetric_and_collocates_but_is_not_symplectic<T: Float>() {
    for (k, s) in [(3, 1), (4, 2), (9, 3), (20, 10)] {
        let method = hbvm::<T>(k, s);
        // 8.2 in f64, 1.6 in double-double, × 2.
        within("B(2k)", b_residual(&method, 2 * k), 16.4);
        // 2.4 in f64, 0.4 in double-double, × 2.
        within("C(s)", c_residual(&method, s), 4.8);
        assert!(c_residual(&method, s + 1) > T::ratio(1, 100));
        // 0.13 in f64, 0.13 in double-double, × 2.
        within("symmetry of HBVM", symmetry_residual(&method), 0.26);
        assert!(
            symplecticity_residual(&method) > T::ratio(1, 10_000),
            "HBVM({k}, {s})"
        );
    }
}

/// s = 1: a_il = c_i b_l, so that all stages lie on the chord.
fn one_degree_is_the_averaged_vector_field<T: Float>() {
    let Tableau { a, b, c } = hbvm::<T>(7, 1);
    for i in 0..7 {
        for l in 0..7 {
            assert!((a[i * 7 + l] - c[i] * b[l]).abs() <= T::EPSILON);
        }
    }
}

/// H = p²/2 + q⁴/4 has degree 4 ≤ 2k/s for k = 2s.
fn a_quartic_energy_is_kept_from_twice_as_many_nodes_on<T: Float>() {
    for s in 1..=3 {
        let kept = energy_error(&hbvm::<T>(2 * s, s));
        let lost = energy_error(&hbvm::<T>(2 * s - 1, s));
        // 1.0 in f64, 0.5 in double-double, × 2.
        within("energy", kept, 2.0);
        assert!(lost > T::ratio(1, 1_000_000_000_000));
    }
}

/// |H(y_1) − H(y_0)| of one step h = ¾ from (q, p) = (1, ⅓), stages iterated until they stand still.
fn energy_error<T: Float>(method: &Tableau<T>) -> T {
    let (h, q0, p0) = (T::ratio(3, 4), T::int(1), T::ratio(1, 3));
    let energy = |q: T, p: T| p * p / T::int(2) + q * q * q * q / T::int(4);
    let mut stages = vec![(q0, p0); method.stages()];
    let step = |weights: &[T], stages: &[(T, T)]| {
        weights
            .iter()
            .zip(stages)
            .fold((q0, p0), |(q_sum, p_sum), (&w, &(q, p))| {
                (q_sum + h * w * p, p_sum - h * w * q * q * q)
            })
    };
    for _ in 0..250 {
        stages = (0..stages.len())
            .map(|i| step(method.row(i), &stages))
            .collect();
    }
    let (q1, p1) = step(&method.b, &stages);
    (energy(q1, p1) - energy(q0, p0)).abs()
}

#[test]
fn impossible_pairs_are_refused() {
    let error = Coefficients::<f64>::hbvm(2, 3).unwrap_err();
    assert_eq!(
        error,
        TableauError::TooFewNodes {
            nodes: 2,
            degree: 3
        }
    );
    assert!(matches!(
        Coefficients::<f64>::hbvm(0, 0),
        Err(TableauError::StagesOutOfRange { .. })
    ));
    assert!(Coefficients::<f64>::hbvm(33, 2).is_err() && Coefficients::<f64>::hbvm(3, 0).is_err());
}

fn hbvm<T: Float>(k: usize, s: usize) -> Tableau<T> {
    Coefficients::hbvm(k, s).unwrap().tableau(&[])
}

/// Boole's rule, and positive weights up to eight nodes.
#[test]
fn trapezoidal_methods_have_newton_cotes_weights() {
    let boole = Coefficients::<f64>::trapezoidal(5).unwrap();
    for (b, exact) in boole.weights().iter().zip([7.0, 32.0, 12.0, 32.0, 7.0]) {
        assert!((b - exact / 90.0).abs() < 1e-16, "{b}");
    }
    for k in 2..=8 {
        let method = Coefficients::<f64>::trapezoidal(k).unwrap();
        let sum: f64 = method.weights().iter().sum();
        assert!((sum - 1.0).abs() < 1e-15 && method.weights().iter().all(|&b| b > 0.0));
        let tableau = method.tableau(&[]);
        assert!(symmetry_residual(&tableau) < 1e-15);
        assert_eq!(equip_tableau::order(&tableau, 1e-12), 2);
    }
    for k in [0, 1, 9] {
        assert!(Coefficients::<f64>::trapezoidal(k).is_err());
    }
}
