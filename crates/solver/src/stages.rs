//! The stages of one step and the first half of system (7): Z − K(α) L(Z) = 0.
//!
//! Unknowns are the stage increments Z_i = Y_i − y0; L_i = h b_i J∇H(Y_i). With K(α) = ½ 1 1ᵀ + U(α), U
//! antisymmetric to the last bit, the residual is
//!
//! $$ R_i = Z_i - \tfrac12 \sum_j L_j - \sum_j U_{ij} L_j . $$
//!
//! Blocks of length n = 2m stand one after the other, stage by stage.

use crate::outcome::Counts;
use crate::state::State;
use equip_autodiff::Evaluate;
use equip_scalar::Float;
use equip_tableau::Gauss;

/// Workspace and current iterate of the stage equations.
#[derive(Debug)]
pub(crate) struct Stages<T: Float> {
    pub(crate) gauss: Gauss<T>,
    /// n = 2m.
    pub(crate) n: usize,
    /// Z_i.
    pub(crate) z: Vec<T>,
    /// L_i at the current Z.
    pub(crate) l: Vec<T>,
    /// Y_i at the current Z.
    pub(crate) points: Vec<T>,
    /// ∇H(Y_i).
    gradients: Vec<T>,
    /// α_1 … α_{s−1}.
    pub(crate) alphas: Vec<T>,
    /// U(α), row by row.
    pub(crate) u: Vec<T>,
    /// Size of each component of the state over the step: the unit in which corrections are measured.
    pub(crate) scale: Vec<T>,
}

impl<T: Float> Stages<T> {
    pub(crate) fn new(gauss: Gauss<T>, n: usize) -> Self {
        let s = gauss.stages();
        let zeros = |len: usize| vec![T::int(0); len];
        let mut stages = Stages {
            n,
            z: zeros(s * n),
            l: zeros(s * n),
            points: zeros(s * n),
            gradients: zeros(s * n),
            alphas: zeros(s - 1),
            u: zeros(s * s),
            scale: zeros(n),
            gauss,
        };
        stages.update_skew();
        stages
    }

    pub(crate) fn count(&self) -> usize {
        self.gauss.stages()
    }

    /// Sets all α's to `alphas` (length s − 1) and U to match.
    pub(crate) fn set_alphas(&mut self, alphas: &[T]) {
        if self.alphas != alphas {
            self.alphas.copy_from_slice(alphas);
            self.update_skew();
        }
    }

    /// Adds `step` times `delta` to the α's.
    pub(crate) fn move_alphas(&mut self, delta: &[T]) {
        for (alpha, &d) in self.alphas.iter_mut().zip(delta) {
            *alpha += d;
        }
        self.update_skew();
    }

    fn update_skew(&mut self) {
        self.gauss.antisymmetric_into(&self.alphas, &mut self.u);
    }

    /// Y_i, ∇H(Y_i) and L_i at the current Z. Returns whether all of them are finite.
    pub(crate) fn evaluate<E: Evaluate<T>>(
        &mut self,
        energy: &mut E,
        y: &State<T>,
        h: T,
        counts: &mut Counts,
    ) -> bool {
        let (n, m) = (self.n, self.n / 2);
        for (point, z) in self.points.chunks_exact_mut(n).zip(self.z.chunks_exact(n)) {
            for j in 0..n {
                point[j] = y.hi[j] + (z[j] + y.lo[j]);
            }
        }
        energy.gradients(&self.points, &mut self.gradients, n);
        counts.gradients += self.count() as u64;
        let mut finite = true;
        for (i, &b) in self.gauss.weights().iter().enumerate() {
            let hb = h * b;
            let (l, g) = (&mut self.l[i * n..][..n], &self.gradients[i * n..][..n]);
            for j in 0..m {
                l[j] = hb * g[m + j];
                l[m + j] = -(hb * g[j]);
            }
            finite &= l.iter().all(|x| x.is_finite());
        }
        finite
    }

    /// K(α) L into `out` (length s·n): the right-hand side of the stage equations.
    pub(crate) fn increments(&self, out: &mut [T]) {
        let (s, n) = (self.count(), self.n);
        let half = T::ratio(1, 2);
        for i in 0..s {
            let row = &mut out[i * n..][..n];
            row.fill(T::int(0));
            for l in self.l.chunks_exact(n) {
                row.iter_mut().zip(l).for_each(|(sum, &x)| *sum += x);
            }
            row.iter_mut().for_each(|sum| *sum *= half);
            for (j, l) in self.l.chunks_exact(n).enumerate() {
                let u = self.u[i * s + j];
                row.iter_mut().zip(l).for_each(|(sum, &x)| *sum += u * x);
            }
        }
    }

    /// T_k L into `out` (length s·n): the derivative of K(α) L by α_k, k = 1 … s − 1.
    pub(crate) fn alpha_derivative(&self, k: usize, out: &mut [T]) {
        let (s, n) = (self.count(), self.n);
        let t = self.gauss.skew_basis(k);
        for i in 0..s {
            let row = &mut out[i * n..][..n];
            row.fill(T::int(0));
            for (j, l) in self.l.chunks_exact(n).enumerate() {
                let t = t[i * s + j];
                row.iter_mut().zip(l).for_each(|(sum, &x)| *sum += t * x);
            }
        }
    }

    /// Measures the components: max(|y_j|, max_i |Z_ij|), no less than ε² of the largest position or momentum.
    ///
    /// A component that is zero throughout gets the size of its group, so that a correction of it by round-off
    /// is seen as the round-off it is.
    pub(crate) fn measure(&mut self, y: &State<T>) {
        let (n, m) = (self.n, self.n / 2);
        for j in 0..n {
            self.scale[j] = self.z[j..]
                .iter()
                .step_by(n)
                .fold(y.hi[j].abs(), |a, z| a.max(z.abs()));
        }
        for group in [0..m, m..n] {
            let scale = &mut self.scale[group];
            let largest = scale.iter().fold(T::int(0), |a, &x| a.max(x));
            let least = if largest > T::int(0) {
                largest * T::EPSILON * T::EPSILON
            } else {
                T::int(1)
            };
            for x in scale {
                *x = x.max(least);
            }
        }
    }

    /// max_ij |x_ij| / scale_j: the size of a correction of the stages relative to the state.
    pub(crate) fn relative_size(&self, x: &[T]) -> T {
        x.chunks_exact(self.n).fold(T::int(0), |largest, block| {
            block
                .iter()
                .zip(&self.scale)
                .fold(largest, |a, (x, &scale)| {
                    let ratio = x.abs() / scale;
                    if ratio > a || Float::is_nan(ratio) {
                        ratio
                    } else {
                        a
                    }
                })
        })
    }
}
