//! B, C, D, symplecticity and symmetry of the Gauss and EQUIP methods.

use crate::common::{Random, within};
use equip_scalar::Float;
use equip_tableau::conditions::{
    b_residual, bilinear_residual, c_residual, d_residual, symmetry_residual,
    symplecticity_residual,
};
use equip_tableau::{Coefficients, Tableau};

crate::common::in_every_float!(
    gauss_has_b_of_2s_and_c_and_d_of_s,
    gauss_has_no_more,
    powers_give_the_same_conditions,
    every_member_is_symplectic_and_symmetric,
    a_perturbed_entry_is_found,
    known_methods_have_their_residuals,
);

fn plain<T: Float>(s: usize) -> Tableau<T> {
    Coefficients::gauss(s)
        .unwrap()
        .tableau(&vec![T::int(0); s - 1])
}

fn gauss_has_b_of_2s_and_c_and_d_of_s<T: Float>() {
    for s in 1..=20 {
        let method = plain::<T>(s);
        // Worst of all s: 9.7, 5.6, 0.5 in f64 and 3.1, 1.0, 0.1 in double-double; × 2.
        within("B(2s)", b_residual(&method, 2 * s), 20.0);
        within("C(s)", c_residual(&method, s), 12.0);
        within("D(s)", d_residual(&method, s), 1.0);
    }
}

/// P_{2s} vanishes at no node, and ∫P_s does not at all of them.
fn gauss_has_no_more<T: Float>() {
    for s in 1..=20 {
        let method = plain::<T>(s);
        assert!(b_residual(&method, 2 * s + 1) > T::ratio(1, 2), "{s}");
        assert!(
            c_residual(&method, s + 1) > T::ratio(1, 20 * s as i64),
            "{s}"
        );
        assert!(
            d_residual(&method, s + 1) > T::ratio(1, 100 * s as i64),
            "{s}"
        );
    }
}

/// B(2s), C(s), D(s) in powers of c, as they are usually printed.
fn powers_give_the_same_conditions<T: Float>() {
    let mut worst = T::int(0);
    for s in 1..=20 {
        let Tableau { a, b, c } = plain::<T>(s);
        let sum = |term: &dyn Fn(usize) -> T| (0..s).fold(T::int(0), |sum, i| sum + term(i));
        for q in 1..=2 * s {
            let power = |i: usize| c[i].powi(q as i32 - 1);
            let one_over_q = T::ratio(1, q as i64);
            worst = worst.max((sum(&|i| b[i] * power(i)) - one_over_q).abs());
            for i in (0..s).filter(|_| q <= s) {
                let collocated = sum(&|j| a[i * s + j] * power(j));
                worst = worst.max((collocated - power(i) * c[i] * one_over_q).abs());
                let transposed = sum(&|j| b[j] * power(j) * a[j * s + i]);
                let expected = b[i] * (T::int(1) - power(i) * c[i]) * one_over_q;
                worst = worst.max((transposed - expected).abs());
            }
        }
    }
    // 1.5 in f64, 0.5 in double-double, × 2.
    within("B, C, D in powers", worst, 3.0);
}

fn every_member_is_symplectic_and_symmetric<T: Float>() {
    let mut random = Random(5);
    for s in 1..=20 {
        let gauss = Coefficients::<T>::gauss(s).unwrap();
        let mut worst = [T::int(0); 2];
        for size in ["0", "1e-8", "0.2", "1"] {
            let method = gauss.tableau(&random.alphas(s - 1, T::decimal(size).unwrap()));
            let scale = method.a.iter().fold(T::int(1), |max, a| max.max(a.abs()));
            worst[0] = worst[0].max(symplecticity_residual(&method) / scale);
            worst[1] = worst[1].max(symmetry_residual(&method) / scale);
        }
        // 0.16 and 0.57 in f64, 0.06 and 0.41 in double-double; × 3 and × 2.
        within("symplecticity", worst[0], 0.5);
        within("symmetry", worst[1], 1.2);
    }
}

fn a_perturbed_entry_is_found<T: Float>() {
    let alpha = T::ratio(1, 10);
    for (s, k) in [(4, 3), (8, 3), (20, 12), (20, 19)] {
        let mut alphas = vec![T::int(0); s - 1];
        alphas[k - 1] = alpha;
        let method = Coefficients::gauss(s).unwrap().tableau(&alphas);
        // 3.4 in f64, 0.8 in double-double, × 2.
        within("bilinear", bilinear_residual(&method, 2 * k), 7.0);
        // 0.25 in f64, 0.17 in double-double, × 2.
        within(
            "alpha",
            (bilinear_residual(&method, 2 * k + 1) - alpha).abs(),
            0.5,
        );
    }
}

fn known_methods_have_their_residuals<T: Float>() {
    let euler = Tableau::<T>::explicit_euler();
    assert_eq!(symplecticity_residual(&euler), T::int(1));
    assert_eq!(symmetry_residual(&euler), T::int(1));
    let trapezoidal = Tableau::<T>::trapezoidal();
    assert_eq!(symplecticity_residual(&trapezoidal), T::ratio(1, 4));
    assert_eq!(symmetry_residual(&trapezoidal), T::int(0));
    let midpoint = plain::<T>(1);
    assert_eq!(symplecticity_residual(&midpoint), T::int(0));
    assert_eq!((midpoint.a[0], midpoint.b[0]), (T::ratio(1, 2), T::int(1)));
}

#[test]
fn a_nan_shows_in_every_residual() {
    let mut method = plain::<f64>(3);
    method.a[4] = f64::NAN;
    for residual in [c_residual, d_residual] {
        assert!(residual(&method, 1).is_nan());
    }
    assert!(symplecticity_residual(&method).is_nan() && symmetry_residual(&method).is_nan());
    method.b[1] = f64::NAN;
    assert!(b_residual(&method, 1).is_nan());
}
