//! K(α): which identities hold to the last bit, and that it is the paper's matrix.

use crate::common::{Random, within};
use equip_scalar::Float;
use equip_tableau::{Coefficients, MAX_STAGES};
use nalgebra::DMatrix;

crate::common::in_every_float!(
    k_and_its_transpose_add_up_to_one_exactly,
    the_antisymmetric_part_is_exact_at_any_alpha,
    the_basis_is_antisymmetric_exactly,
    k_is_the_paper_s_matrix,
    k_is_one_half_plus_its_antisymmetric_part,
);

/// Sizes of α from nothing to where |U_ij| comes near 2⁵² (T_k has entries up to about 100 at s = 64).
fn sizes<T: Float>() -> Vec<T> {
    [
        "0", "1e-300", "1e-20", "1e-9", "0.1", "1", "1e4", "1e8", "1e11",
    ]
    .map(|text| T::decimal(text).unwrap())
    .to_vec()
}

fn k_and_its_transpose_add_up_to_one_exactly<T: Float>() {
    let mut random = Random(1);
    for s in (1..=20).chain([MAX_STAGES]) {
        let gauss = Coefficients::<T>::gauss(s).unwrap();
        for size in sizes::<T>() {
            let k = gauss.matrix(&random.alphas(s - 1, size));
            for i in 0..s {
                assert_eq!(k[i * s + i], T::ratio(1, 2));
                for j in 0..s {
                    let (k_ij, k_ji) = (k[i * s + j], k[j * s + i]);
                    assert_eq!(k_ij + k_ji, T::int(1), "s = {s}, alpha = {size:e}");
                    // Not only the rounded sum: each is the other's complement.
                    assert_eq!(T::two_sum(k_ij, k_ji), (T::int(1), T::int(0)));
                    assert_eq!(k_ij, k[(s - 1 - j) * s + s - 1 - i]);
                }
            }
        }
    }
}

fn the_antisymmetric_part_is_exact_at_any_alpha<T: Float>() {
    let mut random = Random(2);
    for s in 1..=20 {
        let gauss = Coefficients::<T>::gauss(s).unwrap();
        let mut u = vec![T::NAN; s * s];
        for size in [
            sizes(),
            vec![T::decimal("1e30").unwrap(), T::decimal("1e250").unwrap()],
        ]
        .concat()
        {
            gauss.antisymmetric_into(&random.alphas(s - 1, size), &mut u);
            assert!(is_antisymmetric(s, &u));
            assert!((0..s * s).all(|ij| u[ij] == -u[s * s - 1 - ij]));
        }
    }
}

fn the_basis_is_antisymmetric_exactly<T: Float>() {
    for s in [2, 3, 7, 20, MAX_STAGES] {
        let gauss = Coefficients::<T>::gauss(s).unwrap();
        for k in 1..s {
            let t = gauss.skew_basis(k);
            assert!(is_antisymmetric(s, t));
            let (p, q) = (gauss.legendre(k), gauss.legendre(k - 1));
            assert_eq!(t[s - 1], p[0] * q[s - 1] - q[0] * p[s - 1]);
        }
    }
}

fn is_antisymmetric<T: Float>(s: usize, u: &[T]) -> bool {
    (0..s).all(|i| (0..s).all(|j| u[i * s + j] == -u[j * s + i]))
}

/// A(α) B⁻¹ against 𝒫 X_s(α) 𝒫ᵀ by matrix products, with X_s as in eq. (4): ½ in the corner, −(ξ_k + α_k)
/// above and ξ_k + α_k below the diagonal.
fn k_is_the_paper_s_matrix<T: Float>() {
    let mut random = Random(3);
    let mut worst = T::int(0);
    for s in 1..=20 {
        let gauss = Coefficients::<T>::gauss(s).unwrap();
        let alphas = random.alphas(s - 1, T::ratio(1, 5));
        let p = DMatrix::from_fn(s, s, |i, k| gauss.legendre(k)[i]);
        let entry = |k: usize| gauss.xi(k) + alphas[k - 1];
        let x = DMatrix::from_fn(s, s, |i, j| match (i, j) {
            (0, 0) => T::ratio(1, 2),
            _ if i == j + 1 => entry(i),
            _ if j == i + 1 => -entry(j),
            _ => T::int(0),
        });
        let paper = &p * x * p.transpose();
        let k = DMatrix::from_row_slice(s, s, &gauss.matrix(&alphas));
        worst = worst.max((k - paper).amax());
    }
    // 6.0 in f64, 5.0 in double-double, × 2.
    within("K - P X P^T", worst, 12.0);
}

fn k_is_one_half_plus_its_antisymmetric_part<T: Float>() {
    let mut random = Random(4);
    for s in 2..=12 {
        let gauss = Coefficients::<T>::gauss(s).unwrap();
        let alphas = random.alphas(s - 1, T::ratio(1, 5));
        let (k, mut u) = (gauss.matrix(&alphas), vec![T::NAN; s * s]);
        gauss.antisymmetric_into(&alphas, &mut u);
        for (k, u) in k.into_iter().zip(u) {
            assert!((k - T::ratio(1, 2) - u).abs() <= T::EPSILON * k.abs().max(T::int(1)));
        }
    }
}

#[test]
fn a_nan_shows() {
    let k = Coefficients::<f64>::gauss(3)
        .unwrap()
        .matrix(&[0.0, f64::NAN]);
    assert!(k[1].is_nan() && k[3].is_nan());
}

#[test]
#[should_panic(expected = "one alpha for each k")]
fn the_number_of_alphas_must_fit() {
    Coefficients::<f64>::gauss(3).unwrap().matrix(&[0.1]);
}
