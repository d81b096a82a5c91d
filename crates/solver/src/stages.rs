//! The stages of one step and the first half of system (7): Z − K(α) L(Z) = 0.
//!
//! Unknowns are the stage increments Z_i = Y_i − y0; L_i = h b_i J∇H(Y_i). With K(α) = ½ 1 1ᵀ + U(α), U
//! antisymmetric to the last bit, the residual is
//!
//! $$ R_i = Z_i - \tfrac12 \sum_j L_j - \sum_j U_{ij} L_j . $$
//!
//! Blocks of length n = 2m stand one after the other, stage by stage.

use crate::endpoint::EndPoint;
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
    /// All of them are zero, and they are those that swept steps start from: known, as it is asked in every step.
    pub(crate) alphas_are_zero: bool,
    alphas_are_start: bool,
    /// U(α), row by row.
    pub(crate) u: Vec<T>,
    /// U is not that of the α's.
    u_is_stale: bool,
    /// Size of each component of the state over the step: the unit in which corrections are measured.
    pub(crate) scale: Vec<T>,
    pub(crate) end: EndPoint<T>,
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
            alphas_are_zero: true,
            alphas_are_start: false,
            u: zeros(s * s),
            u_is_stale: false,
            scale: zeros(n),
            end: EndPoint::new(s, n),
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
        if self.alphas != alphas || self.u_is_stale {
            self.alphas.copy_from_slice(alphas);
            self.update_skew();
        }
    }

    /// Notes the α's of stages that were swept, which mostly `are_start`: those that such steps start from. U is not made for them.
    pub(crate) fn note_alphas(&mut self, alphas: &[T], are_start: bool) {
        if are_start && self.alphas_are_start {
            return;
        }
        self.u_is_stale |= self.alphas != alphas;
        self.alphas.copy_from_slice(alphas);
        self.see_alphas(are_start);
    }

    fn see_alphas(&mut self, are_start: bool) {
        self.alphas_are_start = are_start;
        self.alphas_are_zero = self.alphas.iter().all(|&alpha| alpha == T::int(0));
    }

    /// Adds `step` times `direction` to the α's.
    pub(crate) fn move_alphas(&mut self, step: T, direction: &[T]) {
        for (alpha, &d) in self.alphas.iter_mut().zip(direction) {
            *alpha += step * d;
        }
        self.update_skew();
    }

    fn update_skew(&mut self) {
        self.u_is_stale = false;
        self.see_alphas(false);
        self.gauss.antisymmetric_into(&self.alphas, &mut self.u);
        self.end.forget_weights();
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

    /// −R = K(α) L − Z into `out` (length s·n), in units of the state.
    pub(crate) fn residual(&self, out: &mut [T]) {
        let (s, n) = (self.count(), self.n);
        let half = T::ratio(1, 2);
        for (i, (row, z)) in out
            .chunks_exact_mut(n)
            .zip(self.z.chunks_exact(n))
            .enumerate()
        {
            row.fill(T::int(0));
            for l in self.l.chunks_exact(n) {
                row.iter_mut().zip(l).for_each(|(sum, &x)| *sum += x);
            }
            row.iter_mut().for_each(|sum| *sum *= half);
            for (j, l) in self.l.chunks_exact(n).enumerate() {
                let u = self.u[i * s + j];
                row.iter_mut().zip(l).for_each(|(sum, &x)| *sum += u * x);
            }
            row.iter_mut().zip(z).for_each(|(sum, &z)| *sum -= z);
        }
        self.to_units(out);
    }

    /// Divides each component by its size.
    pub(crate) fn to_units(&self, x: &mut [T]) {
        for block in x.chunks_exact_mut(self.n) {
            block
                .iter_mut()
                .zip(&self.scale)
                .for_each(|(x, &scale)| *x /= scale);
        }
    }

    /// Z += `step` times `correction`, which is in units of the state.
    pub(crate) fn add(&mut self, step: T, correction: &[T]) {
        for (z, block) in self
            .z
            .chunks_exact_mut(self.n)
            .zip(correction.chunks_exact(self.n))
        {
            for j in 0..self.n {
                z[j] += step * block[j] * self.scale[j];
            }
        }
    }

    /// y1 from the current Z and L.
    pub(crate) fn end_point(&mut self, y: &State<T>, next: &mut State<T>) {
        self.end
            .make(y, (&self.z, &self.l), &self.u, &self.scale, next);
    }

    /// Overwrites in `u` those components of the end point's displacement that are made from the stages.
    pub(crate) fn end_displacement_by_stages(&self, correction: &[T], u: &mut [T]) {
        self.end.displacement(correction, &self.scale, u);
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

    /// Σ_k d_k T_k L into `out` (length s·n).
    pub(crate) fn alpha_derivative_along(&self, d: &[T], out: &mut [T]) {
        let (s, n) = (self.count(), self.n);
        out.fill(T::int(0));
        for (k, &d) in d.iter().enumerate().filter(|(_, d)| **d != T::int(0)) {
            let t = self.gauss.skew_basis(k + 1);
            for (i, row) in out.chunks_exact_mut(n).enumerate() {
                for (j, l) in self.l.chunks_exact(n).enumerate() {
                    let t = d * t[i * s + j];
                    row.iter_mut().zip(l).for_each(|(sum, &x)| *sum += t * x);
                }
            }
        }
    }

    /// Measures the components: max(|y_j|, max_i |Z_ij|), no less than ε² of the largest position or momentum.
    ///
    /// A component that is zero throughout gets the size of its group, so that a correction of it by round-off
    /// is seen as the round-off it is. While the stages are `far` from their solution max_i |L_ij| counts too: Z may
    /// still be zero where it is about to move.
    pub(crate) fn measure(&mut self, y: &State<T>, far: bool) {
        let (n, m) = (self.n, self.n / 2);
        for j in 0..n {
            let size = largest_of(&self.z, j, n).max(y.hi[j].abs());
            self.scale[j] = if far {
                size.max(largest_of(&self.l, j, n))
            } else {
                size
            };
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

    /// The `from_last`-th last Legendre coefficient of the stage derivatives, Σ_i P_k(c_i) L_i, k = s − `from_last`, relative to `sizes`: small
    /// where the motion over the step is smooth, whatever oscillations it might have.
    pub(crate) fn coefficient(&self, from_last: usize, sizes: &[T]) -> T {
        let (s, n) = (self.count(), self.n);
        let p = self.gauss.legendre(s - from_last);
        let component = |j: usize| {
            let terms = p.iter().zip(self.l[j..].iter().step_by(n));
            terms.fold(T::int(0), |sum, (&p, &l)| sum + p * l) / sizes[j]
        };
        let squares = (0..n).map(component);
        squares.fold(T::int(0), |sum, x| sum + x * x).sqrt()
    }

    /// max_i |Y_ij|: sizes of the components that are the same for the step made backwards; no less than ε^(1/4) of the
    /// largest position or momentum, below which rounding elsewhere would be worth more than a component's motion.
    pub(crate) fn sizes(&self, sizes: &mut [T]) {
        for (j, size) in sizes.iter_mut().enumerate() {
            *size = largest_of(&self.points, j, self.n);
        }
        raise_to_least(sizes);
    }
}

/// Raises each of 2m sizes to ε^(1/4) of the largest position or momentum at least.
pub(crate) fn raise_to_least<T: Float>(sizes: &mut [T]) {
    let (share, m) = (T::EPSILON.sqrt().sqrt(), sizes.len() / 2);
    for group in sizes.chunks_exact_mut(m) {
        let least = share * group.iter().fold(T::int(0), |a, &x| a.max(x));
        group.iter_mut().for_each(|x| *x = x.max(least));
    }
}

/// max_i |x_ij| over the blocks i of length n.
fn largest_of<T: Float>(x: &[T], j: usize, n: usize) -> T {
    x[j..]
        .iter()
        .step_by(n)
        .fold(T::int(0), |a, x| a.max(x.abs()))
}
