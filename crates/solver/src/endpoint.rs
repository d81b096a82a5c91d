//! The end point y1, in the one of two equal forms that rounds less.
//!
//! y1 = y0 + Σ L_i is exact for the conservation laws and the natural form. Where the step is stiff, |L_i| exceeds |y| by a factor
//! up to hω and so does the rounding of the sum. There
//!
//! $$ y_1 = y_0 + \sum_i d_i Z_i, \qquad K(\alpha)^T d = 1, $$
//!
//! which is the same since Z = K L (Hairer & Wanner, Solving ODEs II, IV.8), adds terms of the size of the motion.
//! The form is chosen for each component. Cost: comparisons; in stiff steps one factorisation of size s when α moves.

use crate::linear::DenseLu;
use crate::state::State;
use equip_scalar::Float;
use nalgebra::DVector;

/// Σ|L_ij| above this many times the size of the component: the other form is considered.
const STIFF: i64 = 4;

#[derive(Debug)]
pub(crate) struct EndPoint<T: Float> {
    lu: DenseLu<T>,
    d: DVector<T>,
    d_known: bool,
    by_stages: Vec<bool>,
    any_by_stages: bool,
    increments: Vec<T>,
}

impl<T: Float> EndPoint<T> {
    pub(crate) fn new(s: usize, n: usize) -> Self {
        EndPoint {
            lu: DenseLu::new(s),
            d: DVector::zeros(s),
            d_known: false,
            by_stages: vec![false; n],
            any_by_stages: false,
            increments: vec![T::int(0); s * n],
        }
    }

    /// To be called when α has moved.
    pub(crate) fn forget_weights(&mut self) {
        self.d_known = false;
    }

    pub(crate) fn make(
        &mut self,
        y: &State<T>,
        (z, l): (&[T], &[T]),
        u: &[T],
        scale: &[T],
        next: &mut State<T>,
    ) {
        let n = scale.len();
        let sum = |x: &[T], j: usize| x[j..].iter().step_by(n).fold(T::int(0), |a, x| a + x.abs());
        let stiff = (0..n).any(|j| sum(l, j) > T::int(STIFF) * scale[j]);
        self.any_by_stages = stiff && self.find_weights(u);
        if !self.any_by_stages {
            y.advance(l, next);
            return;
        }
        self.increments.copy_from_slice(l);
        for j in 0..n {
            let weighted = z[j..].iter().step_by(n).zip(self.d.iter());
            let by_stages = weighted.fold(T::int(0), |a, (z, d)| a + (*z * *d).abs());
            self.by_stages[j] = by_stages < sum(l, j);
            if self.by_stages[j] {
                for (i, &d) in self.d.iter().enumerate() {
                    self.increments[i * n + j] = d * z[i * n + j];
                }
            }
        }
        y.advance(&self.increments, next);
    }

    /// Components made from the stages move by Σ d_i δZ_i, `correction` being in units of `scale`.
    pub(crate) fn displacement(&self, correction: &[T], scale: &[T], u: &mut [T]) {
        let n = scale.len();
        if !self.any_by_stages {
            return;
        }
        for j in (0..n).filter(|&j| self.by_stages[j]) {
            let weighted = correction[j..].iter().step_by(n).zip(self.d.iter());
            u[j] = scale[j] * weighted.fold(T::int(0), |sum, (x, d)| sum + *x * *d);
        }
    }

    /// d from Kᵀ d = 1, K = ½ 1 1ᵀ + U. Returns whether K is regular.
    fn find_weights(&mut self, u: &[T]) -> bool {
        if self.d_known {
            return true;
        }
        let s = self.d.len();
        let half = T::ratio(1, 2);
        let matrix = self.lu.matrix_mut();
        for i in 0..s {
            for j in 0..s {
                matrix[(j, i)] = half + u[i * s + j];
            }
        }
        if self.lu.factor().is_err() {
            return false;
        }
        self.d.fill(T::int(1));
        self.lu.solve(&mut self.d);
        self.d_known = true;
        true
    }
}
