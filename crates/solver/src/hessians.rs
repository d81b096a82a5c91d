//! ∇²H at the stages of a step, h b_i ∇²H(Y_i), and what is made of products with it.
//!
//! With B_i = h b_i J∇²H(Y_i) the stage equations linearised are M = I − K(α)∘(B_1 … B_s). Nothing here is larger than
//! s times the pattern of ∇²H.
//!
//! Cost: s Hessians to take them; each product 2 s nnz operations, with M another 2 s² n.

use crate::outcome::Counts;
use crate::stages::Stages;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::Float;
use nalgebra::DVector;

#[derive(Debug)]
pub(crate) struct StageHessians<T> {
    pub(crate) pattern: Pattern,
    /// h b_i ∇²H(Y_i): entries in the order of the pattern, stage by stage.
    entries: Vec<T>,
    /// Σ_i h b_i ∇²H(Y_i).
    mean: Vec<T>,
}

impl<T: Float> StageHessians<T> {
    pub(crate) fn new(s: usize, pattern: Pattern) -> Self {
        StageHessians {
            entries: vec![T::int(0); s * pattern.len()],
            mean: vec![T::int(0); pattern.len()],
            pattern,
        }
    }

    /// Evaluates them at the current stages.
    pub(crate) fn take<E: Evaluate<T>>(
        &mut self,
        stages: &Stages<T>,
        energy: &mut E,
        h: T,
        counts: &mut Counts,
    ) {
        let (n, nnz) = (stages.n, self.pattern.len());
        self.mean.fill(T::int(0));
        for (i, &b) in stages.gauss.weights().iter().enumerate() {
            let entries = &mut self.entries[i * nnz..][..nnz];
            energy.hessian(&stages.points[i * n..][..n], entries);
            for (x, mean) in entries.iter_mut().zip(&mut self.mean) {
                *x *= h * b;
                *mean += *x;
            }
        }
        counts.hessians += stages.count() as u64;
    }

    /// h b_i ∇²H(Y_i) in the order of the pattern.
    pub(crate) fn of_stage(&self, i: usize) -> &[T] {
        let nnz = self.pattern.len();
        &self.entries[i * nnz..][..nnz]
    }

    /// out = B_i x, both in units of `Stages::scale`.
    pub(crate) fn turn(&self, stages: &Stages<T>, i: usize, x: &[T], out: &mut [T]) {
        let (n, entries) = (stages.n, self.of_stage(i));
        for row in 0..n {
            let product = self.pattern.row(row).fold(T::int(0), |sum, (position, j)| {
                sum + entries[position] * (x[j] * stages.scale[j])
            });
            let (r, sign) = turned::<T>(row, n);
            out[r] = sign * product / stages.scale[r];
        }
    }

    /// out = B_iᵀ x, both in units of `Stages::scale`.
    pub(crate) fn turn_transposed(&self, stages: &Stages<T>, i: usize, x: &[T], out: &mut [T]) {
        let (n, entries) = (stages.n, self.of_stage(i));
        for (row, out) in out.iter_mut().enumerate() {
            // Column `row` of J∇²H is row `row` of ∇²H Jᵀ, with the other sign of J.
            let product = self.pattern.row(row).fold(T::int(0), |sum, (position, j)| {
                let (r, sign) = turned::<T>(j, n);
                sum + entries[position] * (sign * x[r] / stages.scale[r])
            });
            *out = product * stages.scale[row];
        }
    }

    /// u = Σ_i B_i x_i, in units of the state: how the end point moves with the stages.
    pub(crate) fn end_displacement(&self, stages: &Stages<T>, x: &DVector<T>, u: &mut [T]) {
        let n = stages.n;
        u.fill(T::int(0));
        for i in 0..stages.count() {
            let entries = self.of_stage(i);
            for row in 0..n {
                let product = self.pattern.row(row).fold(T::int(0), |sum, (position, j)| {
                    sum + entries[position] * x[i * n + j] * stages.scale[j]
                });
                let (r, sign) = turned::<T>(row, n);
                u[r] += sign * product;
            }
        }
    }

    /// B_iᵀ J u = h b_i ∇²H_i Jᵀ J u = h b_i ∇²H_i u for all i into `out`, in units of `Stages::scale`.
    pub(crate) fn pull_back(&self, stages: &Stages<T>, u: &[T], out: &mut DVector<T>) {
        let n = stages.n;
        for i in 0..stages.count() {
            let entries = self.of_stage(i);
            for row in 0..n {
                let product = self.pattern.row(row).fold(T::int(0), |sum, (position, j)| {
                    sum + entries[position] * u[j]
                });
                out[i * n + row] = product * stages.scale[row];
            }
        }
    }

    /// How far each component is from being resolved by the step.
    pub(crate) fn resolution(&self, weights: &mut [T]) {
        resolution(&self.pattern, &self.mean, weights);
    }

    /// Whether some ρ_j of the stages taken last exceeds `limit`.
    pub(crate) fn any_rho_exceeds(&self, limit: T) -> bool {
        (0..self.pattern.dimension()).any(|j| rho(&self.pattern, &self.mean, j) > limit)
    }
}

/// How far each component is from being resolved by the step: 1 / (1 + ρ_j), where ρ_j = Σ_k |G_jk G_kj| with
/// G = J Σ_i h b_i ∇²H(Y_i), whose entries are `mean`. For an oscillator ρ = (hω)². Independent of the units of q and p, and the same
/// when the step is made backwards.
pub(crate) fn resolution<T: Float>(pattern: &Pattern, mean: &[T], weights: &mut [T]) {
    for (j, weight) in weights.iter_mut().enumerate() {
        *weight = T::int(1) / (T::int(1) + rho(pattern, mean, j));
    }
}

fn rho<T: Float>(pattern: &Pattern, mean: &[T], j: usize) -> T {
    let n = pattern.dimension();
    let entry = |row: usize, column: usize| {
        let range = pattern.row_starts[row]..pattern.row_starts[row + 1];
        match pattern.columns[range.clone()].binary_search(&column) {
            Ok(offset) => mean[range.start + offset],
            Err(_) => T::int(0),
        }
    };
    let (row, _) = turned::<T>(j, n);
    pattern.row(row).fold(T::int(0), |sum, (position, k)| {
        let (partner, _) = turned::<T>(k, n);
        sum + (mean[position] * entry(partner, j)).abs()
    })
}

/// Row `row` of a matrix A stands in row r of J A, with a sign. J = (0 I; −I 0) takes it there and back alike.
pub(crate) fn turned<T: Float>(row: usize, n: usize) -> (usize, T) {
    let m = n / 2;
    if row < m {
        (row + m, -T::int(1))
    } else {
        (row - m, T::int(1))
    }
}
