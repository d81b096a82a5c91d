//! B, C, D, symplecticity and symmetry of the Gauss and EQUIP methods.

use crate::common::Random;
use equip_scalar::Float;
use equip_tableau::conditions::{
    b_defect, bilinear_defect, c_defect, d_defect, symmetry_defect, symplecticity_defect,
};
use equip_tableau::{Gauss, Tableau};

crate::common::in_every_float!(
    gauss_has_b_of_2s_and_c_and_d_of_s,
    gauss_has_no_more,
    powers_give_the_same_conditions,
    every_member_is_symplectic_and_symmetric,
    a_perturbed_entry_is_found,
    known_methods_have_their_defects,
);

fn plain<T: Float>(s: usize) -> Tableau<T> {
    Gauss::new(s).unwrap().tableau(&vec![T::int(0); s - 1])
}

fn gauss_has_b_of_2s_and_c_and_d_of_s<T: Float>() {
    for s in 1..=20 {
        let method = plain::<T>(s);
        let b = b_defect(&method, 2 * s);
        let (c, d) = (c_defect(&method, s), d_defect(&method, s));
        let in_eps = |x: T| (x / T::EPSILON).to_f64();
        println!(
            "{s}: B {:.1} C {:.1} D {:.1} eps",
            in_eps(b),
            in_eps(c),
            in_eps(d)
        );
        assert!(b <= T::int(16) * T::EPSILON);
        assert!(c <= T::int(16) * T::EPSILON);
        assert!(d <= T::int(16) * T::EPSILON);
    }
}

/// P_{2s} vanishes at no node, and ∫P_s does not at all of them.
fn gauss_has_no_more<T: Float>() {
    for s in 1..=20 {
        let method = plain::<T>(s);
        assert!(b_defect(&method, 2 * s + 1) > T::ratio(1, 2), "{s}");
        assert!(c_defect(&method, s + 1) > T::ratio(1, 20 * s as i64), "{s}");
        assert!(
            d_defect(&method, s + 1) > T::ratio(1, 100 * s as i64),
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
    println!("{:.1} eps", (worst / T::EPSILON).to_f64());
    assert!(worst <= T::int(8) * T::EPSILON);
}

fn every_member_is_symplectic_and_symmetric<T: Float>() {
    let mut random = Random(5);
    for s in 1..=20 {
        let gauss = Gauss::<T>::new(s).unwrap();
        let mut worst = [T::int(0); 2];
        for size in ["0", "1e-8", "0.2", "1"] {
            let method = gauss.tableau(&random.alphas(s - 1, T::decimal(size).unwrap()));
            let scale = method.a.iter().fold(T::int(1), |max, a| max.max(a.abs())) * T::EPSILON;
            worst[0] = worst[0].max(symplecticity_defect(&method) / scale);
            worst[1] = worst[1].max(symmetry_defect(&method) / scale);
        }
        println!(
            "{s}: symplectic {:.2}, symmetric {:.2} eps",
            worst[0].to_f64(),
            worst[1].to_f64()
        );
        assert!(worst.iter().all(|&worst| worst <= T::int(2)));
    }
}

fn a_perturbed_entry_is_found<T: Float>() {
    let alpha = T::ratio(1, 10);
    for (s, k) in [(4, 3), (8, 3), (20, 12), (20, 19)] {
        let mut alphas = vec![T::int(0); s - 1];
        alphas[k - 1] = alpha;
        let method = Gauss::new(s).unwrap().tableau(&alphas);
        assert!(bilinear_defect(&method, 2 * k) <= T::int(40) * T::EPSILON);
        let error = (bilinear_defect(&method, 2 * k + 1) - alpha).abs();
        assert!(error <= T::int(40) * T::EPSILON);
    }
}

fn known_methods_have_their_defects<T: Float>() {
    let euler = Tableau::<T>::explicit_euler();
    assert_eq!(symplecticity_defect(&euler), T::int(1));
    assert_eq!(symmetry_defect(&euler), T::int(1));
    let trapezoidal = Tableau::<T>::trapezoidal();
    assert_eq!(symplecticity_defect(&trapezoidal), T::ratio(1, 4));
    assert_eq!(symmetry_defect(&trapezoidal), T::int(0));
    let midpoint = plain::<T>(1);
    assert_eq!(symplecticity_defect(&midpoint), T::int(0));
    assert_eq!((midpoint.a[0], midpoint.b[0]), (T::ratio(1, 2), T::int(1)));
}

#[test]
fn a_nan_shows_in_every_defect() {
    let mut method = plain::<f64>(3);
    method.a[4] = f64::NAN;
    for defect in [c_defect, d_defect] {
        assert!(defect(&method, 1).is_nan());
    }
    assert!(symplecticity_defect(&method).is_nan() && symmetry_defect(&method).is_nan());
    method.b[1] = f64::NAN;
    assert!(b_defect(&method, 1).is_nan());
}
