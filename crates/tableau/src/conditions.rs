//! Conditions on a tableau, as functions that return the largest absolute residual.
//!
//! The simplifying assumptions of Butcher (1964) are stated with the orthonormal Legendre polynomials instead
//! of powers of c:
//!
//! | | for all k | usual form, q = 1 … |
//! |---|---|---|
//! | B(p) | Σ_i b_i P_k(c_i) = δ_k0, k < p | Σ b_i c_i^{q−1} = 1/q |
//! | C(η) | Σ_j a_ij P_k(c_j) = ∫₀^{c_i} P_k, k < η | Σ a_ij c_j^{q−1} = c_i^q/q |
//! | D(ζ) | Σ_i b_i P_k(c_i) a_ij = b_j ∫_{c_j}^1 P_k, k < ζ | Σ b_i c_i^{q−1} a_ij = b_j(1 − c_j^q)/q |
//!
//! Powers and Legendre polynomials span the same space, so the conditions are equivalent. With powers,
//! however, the residual of a condition of degree q that is violated is smaller by a factor of about 4^{−q};
//! at q = 25 that factor is below the rounding of an `f64`. In Legendre form a violated condition has a
//! residual of order one.
//!
//! A residual is NaN if the tableau contains NaN. Cost: O(s² n) for n conditions.

use crate::coefficients::xi;
use crate::legendre::{legendre_at, legendre_integrals_at};
use crate::tableau::{Tableau, dot};
use equip_scalar::Float;

/// B(p): the quadrature rule is exact for polynomials of degree p − 1. Gauss satisfies B(2s).
///
/// ```
/// use equip_tableau::{Tableau, conditions::b_residual};
/// assert!(b_residual(&Tableau::<f64>::classic(), 4) < 1e-15);
/// assert!(b_residual(&Tableau::<f64>::classic(), 5) > 0.01);
/// ```
pub fn b_residual<T: Float>(tableau: &Tableau<T>, p: usize) -> T {
    let values = polynomials_at_nodes(tableau, p);
    let residual = |(k, p_k): (usize, &Vec<T>)| dot(&tableau.b, p_k) - delta(k);
    largest(values.iter().enumerate().map(residual))
}

/// C(η): the stage values satisfy the collocation conditions up to degree η. Gauss satisfies C(s).
///
/// ```
/// use equip_tableau::{Tableau, conditions::c_residual};
/// assert!(c_residual(&Tableau::<f64>::radau_iia(), 2) < 1e-15);
/// ```
pub fn c_residual<T: Float>(tableau: &Tableau<T>, eta: usize) -> T {
    let values = polynomials_at_nodes(tableau, eta);
    let integrals = integrals_at_nodes(tableau, eta);
    largest(values.iter().zip(&integrals).flat_map(|(p_k, integral_k)| {
        let image = tableau.apply(p_k);
        image
            .into_iter()
            .zip(integral_k)
            .map(|(x, &y)| x - y)
            .collect::<Vec<T>>()
    }))
}

/// D(ζ): the condition for the transposed matrix. Gauss satisfies D(s).
///
/// ```
/// use equip_tableau::{Tableau, conditions::d_residual};
/// assert!(d_residual(&Tableau::<f64>::classic(), 1) < 1e-15);
/// ```
pub fn d_residual<T: Float>(tableau: &Tableau<T>, zeta: usize) -> T {
    let values = polynomials_at_nodes(tableau, zeta);
    let integrals = integrals_at_nodes(tableau, zeta);
    let (s, b) = (tableau.stages(), &tableau.b);
    largest(
        values
            .iter()
            .zip(&integrals)
            .enumerate()
            .flat_map(|(k, (p_k, integral_k))| {
                (0..s).map(move |j| {
                    let sum = (0..s).fold(T::int(0), |sum, i| {
                        sum + b[i] * p_k[i] * tableau.a[i * s + j]
                    });
                    sum - b[j] * (delta::<T>(k) - integral_k[j])
                })
            }),
    )
}

/// The order conditions of trees whose root carries a leaves and one branch with b leaves, a + b + 2 ≤ p, in
/// Legendre form: Σ b_i P_a(c_i) a_ij P_b(c_j) = ∫₀¹ P_a(c) ∫₀ᶜ P_b. The right-hand sides are the entries of
/// X_s(0) in the paper.
///
/// They are necessary for order p if C(1) holds. Their residuals show which entry of X_s(0) an α_k has
/// changed.
///
/// ```
/// use equip_tableau::{Coefficients, conditions::bilinear_residual};
/// let perturbed = Coefficients::<f64>::gauss(8)?.tableau(&[0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0]);
/// assert!(bilinear_residual(&perturbed, 6) < 1e-14);
/// assert!((bilinear_residual(&perturbed, 7) - 0.1).abs() < 1e-14);
/// # Ok::<(), equip_tableau::TableauError>(())
/// ```
pub fn bilinear_residual<T: Float>(tableau: &Tableau<T>, p: usize) -> T {
    let n = p.saturating_sub(1);
    let values = polynomials_at_nodes(tableau, n);
    largest(values.iter().enumerate().flat_map(|(b, p_b)| {
        let image = tableau.apply(p_b);
        let weighted: Vec<T> = image.iter().zip(&tableau.b).map(|(&x, &b)| b * x).collect();
        let entry = move |(a, p_a): (usize, &Vec<T>)| dot(p_a, &weighted) - x_entry::<T>(a, b);
        values.iter().take(n - b).enumerate().map(entry)
    }))
}

/// b_i a_ij + b_j a_ji = b_i b_j for all i, j: the method is symplectic and conserves quadratic invariants
/// (Sanz-Serna 1988; Lasagni 1988; Suris 1988).
///
/// ```
/// use equip_tableau::{Tableau, conditions::symplecticity_residual};
/// assert_eq!(symplecticity_residual(&Tableau::<f64>::trapezoidal()), 0.25);
/// ```
pub fn symplecticity_residual<T: Float>(tableau: &Tableau<T>) -> T {
    let (s, a, b) = (tableau.stages(), &tableau.a, &tableau.b);
    largest(
        (0..s).flat_map(|i| {
            (i..s).map(move |j| b[i] * a[i * s + j] + b[j] * a[j * s + i] - b[i] * b[j])
        }),
    )
}

/// a_{s+1−i,s+1−j} + a_ij = b_j and b_{s+1−i} = b_i: the method is symmetric, so its order is even (Stetter
/// 1973; Wanner 1973). The stages are in the given order, c_{s+1−i} = 1 − c_i.
///
/// ```
/// use equip_tableau::{Tableau, conditions::symmetry_residual};
/// assert_eq!(symmetry_residual(&Tableau::<f64>::trapezoidal()), 0.0);
/// ```
pub fn symmetry_residual<T: Float>(tableau: &Tableau<T>) -> T {
    let (s, a, b) = (tableau.stages(), &tableau.a, &tableau.b);
    let of_a = (0..s * s).map(|ij| a[ij] + a[s * s - 1 - ij] - b[ij % s]);
    let of_b = (0..s).map(|i| b[i] - b[s - 1 - i]);
    largest(of_a.chain(of_b))
}

/// Entry (a, b), counted from 0, of the tridiagonal matrix ∫₀¹ P_a(c) ∫₀ᶜ P_b: ½ at (0, 0), ξ below and −ξ
/// above the diagonal.
fn x_entry<T: Float>(a: usize, b: usize) -> T {
    if a == 0 && b == 0 {
        T::ratio(1, 2)
    } else if a == b + 1 {
        xi(a)
    } else if b == a + 1 {
        -xi::<T>(b)
    } else {
        T::int(0)
    }
}

/// δ_k0 = ∫₀¹ P_k.
fn delta<T: Float>(k: usize) -> T {
    T::int(i64::from(k == 0))
}

/// P_0 … P_{n−1}, each at all nodes of the tableau.
fn polynomials_at_nodes<T: Float>(tableau: &Tableau<T>, n: usize) -> Vec<Vec<T>> {
    at_nodes(tableau, n, legendre_at)
}

/// ∫₀^{c_i} P_0 … P_{n−1}, each for all nodes.
fn integrals_at_nodes<T: Float>(tableau: &Tableau<T>, n: usize) -> Vec<Vec<T>> {
    at_nodes(tableau, n, legendre_integrals_at)
}

fn at_nodes<T: Float>(tableau: &Tableau<T>, n: usize, functions: fn(T, &mut [T])) -> Vec<Vec<T>> {
    let mut values = vec![vec![T::int(0); tableau.stages()]; n];
    let mut at_c = vec![T::int(0); n];
    for (i, &c_i) in tableau.c.iter().enumerate() {
        functions(c_i, &mut at_c);
        for (row, &value) in values.iter_mut().zip(&at_c) {
            row[i] = value;
        }
    }
    values
}

/// The largest absolute value; NaN if any value is NaN; 0 for an empty iterator.
pub(crate) fn largest<T: Float>(defects: impl Iterator<Item = T>) -> T {
    defects.fold(T::int(0), |worst, residual| {
        let size = residual.abs();
        if size > worst || size.is_nan() {
            size
        } else {
            worst
        }
    })
}
