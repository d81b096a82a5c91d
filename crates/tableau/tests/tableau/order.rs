//! The order of the methods, by rooted trees and by simplifying assumptions.

use crate::common::{Random, within};
use equip_scalar::Float;
use equip_tableau::trees::{Trees, order_conditions};
use equip_tableau::{Coefficients, Tableau, TableauError, order};

crate::common::in_every_float!(
    classical_methods_have_their_order,
    gauss_has_order_2s,
    a_fixed_last_alpha_leaves_order_2s_minus_2,
    the_first_perturbed_alpha_decides_the_order,
    trees_agree_with_the_simplifying_assumptions,
    hbvm_has_order_2s,
);

fn tolerance<T: Float>() -> T {
    T::int(1000) * T::EPSILON
}

fn perturbed<T: Float>(s: usize, k: usize) -> Tableau<T> {
    let mut alphas = vec![T::int(0); s - 1];
    alphas[k - 1] = T::ratio(1, 10);
    Coefficients::gauss(s).unwrap().tableau(&alphas)
}

/// A000081, and γ of the tall and the bushy tree.
#[test]
fn every_tree_is_there_once() {
    let trees = Trees::up_to(12);
    let count = |n| trees.all().iter().filter(|tree| tree.order() == n).count();
    let counts: Vec<usize> = (1..=12).map(count).collect();
    assert_eq!(counts, [1, 1, 2, 4, 9, 20, 48, 115, 286, 719, 1842, 4766]);
    let of_six = || {
        trees
            .all()
            .iter()
            .filter(|tree| tree.order() == 6)
            .map(|tree| tree.density())
    };
    assert_eq!((of_six().min(), of_six().max()), (Some(6), Some(720)));
    let mut shapes: Vec<&[usize]> = trees.all().iter().map(|tree| tree.branches()).collect();
    shapes.sort();
    shapes.dedup();
    assert_eq!(shapes.len(), trees.all().len());
}

fn classical_methods_have_their_order<T: Float>() {
    let of = |method: Tableau<T>| order(&method, tolerance());
    assert_eq!(of(Tableau::explicit_euler()), 1);
    assert_eq!(of(Tableau::trapezoidal()), 2);
    assert_eq!(of(Tableau::radau_iia()), 3);
    assert_eq!(of(Tableau::classic()), 4);
    let inconsistent = Tableau::new(vec![T::int(0)], vec![T::ratio(1, 2)]).unwrap();
    assert_eq!(of(inconsistent), 0);
}

fn gauss_has_order_2s<T: Float>() {
    for s in 1..=20 {
        let method = Coefficients::<T>::gauss(s)
            .unwrap()
            .tableau(&vec![T::int(0); s - 1]);
        assert_eq!(order(&method, tolerance()), 2 * s);
    }
}

/// All 37 trees up to order 6 hold for s = 4, and one of the 48 of order 7 does not.
fn a_fixed_last_alpha_leaves_order_2s_minus_2<T: Float>() {
    for s in 2..=4 {
        let method = perturbed::<T>(s, s - 1);
        // 0.25 in f64, 0.28 in double-double, × 2.
        within("order 2s - 2", order_conditions(&method, 2 * s - 2), 0.6);
        assert!(
            order_conditions(&method, 2 * s - 1) > T::ratio(1, 10_000),
            "{s}"
        );
    }
    for s in 2..=20 {
        assert_eq!(order(&perturbed::<T>(s, s - 1), tolerance()), 2 * s - 2);
    }
}

fn the_first_perturbed_alpha_decides_the_order<T: Float>() {
    let mut random = Random(6);
    for s in [2, 3, 4, 6, 9] {
        for k in 1..s {
            assert_eq!(
                order(&perturbed::<T>(s, k), tolerance()),
                2 * k,
                "s = {s}, k = {k}"
            );
            let mut alphas = vec![T::int(0); s - 1];
            for alpha in &mut alphas[k - 1..] {
                *alpha = T::ratio(1, 20) + T::ratio(1, 40) * random.symmetric::<T>();
            }
            let method = Coefficients::gauss(s).unwrap().tableau(&alphas);
            assert_eq!(order(&method, tolerance()), 2 * k, "s = {s}, from k = {k}");
        }
    }
}

fn trees_agree_with_the_simplifying_assumptions<T: Float>() {
    for s in 2..=6 {
        for k in (1..s).filter(|&k| k <= 4) {
            let method = perturbed::<T>(s, k);
            // 0.5 in f64, 0.31 in double-double, × 2.
            within("order 2k", order_conditions(&method, 2 * k), 1.0);
            assert!(
                order_conditions(&method, 2 * k + 1) > T::ratio(1, 1_000_000),
                "{s} {k}"
            );
        }
    }
    let gauss = Coefficients::<T>::gauss(5)
        .unwrap()
        .tableau(&[T::int(0); 4]);
    // 0.5 in f64, 0.25 in double-double, × 2.
    within("order 2s of Gauss", order_conditions(&gauss, 10), 1.0);
}

fn hbvm_has_order_2s<T: Float>() {
    for (k, s) in [
        (1, 1),
        (5, 1),
        (4, 2),
        (6, 2),
        (6, 3),
        (9, 3),
        (8, 4),
        (20, 10),
        (30, 10),
    ] {
        assert_eq!(
            order(&hbvm::<T>(k, s), tolerance()),
            2 * s,
            "HBVM({k}, {s})"
        );
    }
}

#[test]
fn a_matrix_of_the_wrong_shape_is_refused() {
    let error = Tableau::new(vec![0.0; 3], vec![0.5; 2]).unwrap_err();
    assert_eq!(
        error,
        TableauError::ShapeMismatch {
            entries: 3,
            stages: 2
        }
    );
    assert!(Tableau::<f64>::new(vec![], vec![]).is_err());
}

fn hbvm<T: Float>(k: usize, s: usize) -> Tableau<T> {
    Coefficients::hbvm(k, s).unwrap().tableau(&[])
}
