//! The polynomials, their integrals and derivatives.

use crate::common::within;
use equip_scalar::Float;
use equip_tableau::{Coefficients, legendre_at, legendre_derivatives_at, legendre_integrals_at};

crate::common::in_every_float!(
    the_first_polynomials_are_the_textbook_ones,
    integrals_are_differences_of_neighbours,
    integrals_vanish_at_both_ends,
    integrals_keep_relative_accuracy_near_the_ends,
    the_integral_of_the_derivative_is_the_polynomial,
    nodes_are_zeros,
);

/// Inside, at the ends, and outside of [0, 1].
fn arguments<T: Float>() -> Vec<T> {
    (-5..=25).map(|n| T::ratio(n, 20)).collect()
}

fn the_first_polynomials_are_the_textbook_ones<T: Float>() {
    let int = T::int;
    let mut worst = T::int(0);
    for c in arguments::<T>() {
        let mut p = [T::NAN; 4];
        legendre_at(c, &mut p);
        let expected = [
            int(1),
            int(3).sqrt() * (int(2) * c - int(1)),
            int(5).sqrt() * ((int(6) * c - int(6)) * c + int(1)),
            int(7).sqrt() * (((int(20) * c - int(30)) * c + int(12)) * c - int(1)),
        ];
        for (x, y) in p.into_iter().zip(expected) {
            worst = worst.max((x - y).abs());
        }
    }
    // 48, by cancellation in the textbook form, in f64, 12 in double-double, × 2.
    within("textbook", worst, 96.0);
}

fn integrals_are_differences_of_neighbours<T: Float>() {
    const N: usize = 20;
    let gauss = Coefficients::<T>::gauss(1).unwrap();
    let mut worst = T::int(0);
    for c in arguments::<T>() {
        let (mut p, mut integrals) = ([T::NAN; N + 1], [T::NAN; N]);
        legendre_at(c, &mut p);
        legendre_integrals_at(c, &mut integrals);
        assert_eq!(integrals[0], c);
        for k in 1..N {
            let (up, down) = (gauss.xi(k + 1) * p[k + 1], gauss.xi(k) * p[k - 1]);
            let error = (integrals[k] - (up - down)).abs();
            worst = worst.max(error / (up.abs() + down.abs()));
        }
    }
    // 1.5 in f64, 1.0 in double-double, × 2.
    within("neighbours", worst, 3.0);
}

fn integrals_vanish_at_both_ends<T: Float>() {
    for end in [T::int(0), T::int(1)] {
        let mut integrals = [T::NAN; 30];
        legendre_integrals_at(end, &mut integrals);
        assert!(integrals[1..].iter().all(|&x| x == T::int(0)));
    }
}

/// ∫₀ᶜ P_k = (−1)^k √(2k+1) c (1 − k(k+1) c / 2 + …).
fn integrals_keep_relative_accuracy_near_the_ends<T: Float>() {
    let c = T::EPSILON * T::EPSILON;
    let mut integrals = [T::NAN; 20];
    legendre_integrals_at(c, &mut integrals);
    for (k, integral) in integrals.into_iter().enumerate() {
        let sign = if k % 2 == 0 { 1 } else { -1 };
        let leading = T::int(sign) * T::int(2 * k as i64 + 1).sqrt() * c;
        // 1.0 in f64, 0.7 in double-double, × 2.
        within("near the end", (integral / leading - T::int(1)).abs(), 2.0);
    }
}

fn the_integral_of_the_derivative_is_the_polynomial<T: Float>() {
    const N: usize = 20;
    let gauss = Coefficients::<T>::gauss(N).unwrap();
    let mut worst = T::int(0);
    for c in arguments::<T>() {
        let (mut at_c, mut at_0, mut slopes) = ([T::NAN; N], [T::NAN; N], [T::NAN; N]);
        legendre_at(c, &mut at_c);
        legendre_at(T::int(0), &mut at_0);
        let mut sums = [T::int(0); N];
        let mut sizes = [T::int(1); N];
        for (&node, &weight) in gauss.nodes().iter().zip(gauss.weights()) {
            legendre_derivatives_at(node * c, &mut slopes);
            for k in 0..N {
                sums[k] += c * weight * slopes[k];
                sizes[k] += (c * weight * slopes[k]).abs();
            }
        }
        for k in 0..N {
            let error = (sums[k] - (at_c[k] - at_0[k])).abs();
            worst = worst.max(error / sizes[k]);
        }
    }
    // 14 in f64, 4 in double-double, × 2.
    within("integral of the derivative", worst, 28.0);
}

fn nodes_are_zeros<T: Float>() {
    for s in 1..=20 {
        let (mut p, mut slopes) = (vec![T::NAN; s + 1], vec![T::NAN; s + 1]);
        for &c in Coefficients::<T>::gauss(s).unwrap().nodes() {
            legendre_at(c, &mut p);
            legendre_derivatives_at(c, &mut slopes);
            // 0.38 in f64, 0.12 in double-double, × 2.
            within("zeros", (p[s] / slopes[s]).abs(), 0.8);
        }
    }
}
