//! The α that satisfies the constraints with the least displacement of the end point.
//!
//! To first order α changes the end point by U α, U = (u_1 … u_f), and the constraints by Vᵀ α. Among all α
//! with Vᵀ α = −g, the minimiser of ½ |U α|² + ½ r Σ_k |u_k|² α_k² is
//!
//! $$ \alpha = D\,t, \qquad D = (G + r\,\mathrm{diag}\,G)^{-1} V, \qquad G = U^T U, $$
//!
//! with t determined by the constraints. The norm includes both ends of the step: u_k with the start held,
//! and u'_k = −Ψ⁻¹u_k with the end held, each component in units of its own change. The reversed step
//! therefore has the same D.
//!
//! Cost: f² n operations and a factorisation of size f, the number of free parameters.

use crate::policy::RIDGE;
use equip_linear::DenseLu;
use equip_scalar::Float;
use nalgebra::{DMatrix, DVector};

/// G and its factorisation.
#[derive(Debug)]
pub(crate) struct LeastDisplacement<T: Float> {
    gram: DenseLu<T>,
    norms: Vec<T>,
    x: DVector<T>,
}

impl<T: Float> LeastDisplacement<T> {
    pub(crate) fn new(free: usize) -> Self {
        LeastDisplacement {
            gram: DenseLu::new(free),
            norms: vec![T::int(0); free],
            x: DVector::zeros(free),
        }
    }

    /// Computes D from the displacements, 2n weighted numbers for each free parameter, and V. Column a of V
    /// and of D belongs to constraint a. The largest entry of each column of D is 1. Returns whether D
    /// exists.
    pub(crate) fn solve(&mut self, rows: &[Vec<T>], v: &DMatrix<T>, d: &mut DMatrix<T>) -> bool {
        let (zero, one) = (T::int(0), T::int(1));
        let finite = |x: T| if x.is_finite() { x } else { zero };
        for (norm, row) in self.norms.iter_mut().zip(rows) {
            *norm = dot(row, row).sqrt();
        }
        let matrix = self.gram.matrix_mut();
        for (k, row) in rows.iter().enumerate() {
            matrix[(k, k)] = one + T::ratio(1, RIDGE);
            for (l, other) in rows.iter().enumerate().take(k) {
                let x = finite(dot(row, other) / self.norms[k] / self.norms[l]);
                (matrix[(k, l)], matrix[(l, k)]) = (x, x);
            }
        }
        if self.gram.factor().is_err() {
            return false;
        }
        for (a, mut column) in d.column_iter_mut().enumerate() {
            for (k, x) in self.x.iter_mut().enumerate() {
                *x = finite(v[(k, a)] / self.norms[k]);
            }
            self.gram.solve(&mut self.x);
            for (k, d) in column.iter_mut().enumerate() {
                *d = finite(self.x[k] / self.norms[k]);
            }
            let largest = column.iter().fold(zero, |a, x| a.max(x.abs()));
            if !(largest > zero) {
                return false;
            }
            column.iter_mut().for_each(|d| *d /= largest);
        }
        true
    }
}

/// The scalar product, as eight partial sums.
pub(crate) fn dot<T: Float>(a: &[T], b: &[T]) -> T {
    let ((eights_a, rest_a), (eights_b, rest_b)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [T::int(0); 8];
    for (a, b) in eights_a.iter().zip(eights_b) {
        for (sum, (&x, &y)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += x * y;
        }
    }
    let terms = rest_a.iter().zip(rest_b).map(|(&x, &y)| x * y);
    sums.into_iter()
        .chain(terms)
        .fold(T::int(0), |sum, x| sum + x)
}
