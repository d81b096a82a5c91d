//! System (7) linearised at the current stages: M = I − K(α)∘(B_1 … B_s) with B_i = h b_i J∇²H(Y_i).
//!
//! All vectors of stages are in units of `Stages::scale`, which makes M independent of the units of q and p.
//! Cost: s Hessians and 2/3 (s n)³ operations to factorise, 2 (s n)² for each solve.

use crate::linear::{DenseLu, Singular};
use crate::outcome::Counts;
use crate::stages::Stages;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::Float;
use nalgebra::DVector;

#[derive(Debug)]
pub(crate) struct Linearisation<T: Float> {
    lu: DenseLu<T>,
    pattern: Pattern,
    /// h b_i ∇²H(Y_i): entries in the order of the pattern, stage by stage.
    hessians: Vec<T>,
    /// Σ_i h b_i ∇²H(Y_i).
    mean: Vec<T>,
    work: DVector<T>,
}

impl<T: Float> Linearisation<T> {
    pub(crate) fn new(s: usize, pattern: Pattern) -> Self {
        let (n, nnz) = (pattern.dimension(), pattern.len());
        Linearisation {
            lu: DenseLu::new(s * n),
            hessians: vec![T::int(0); s * nnz],
            mean: vec![T::int(0); nnz],
            work: DVector::zeros(s * n),
            pattern,
        }
    }

    /// Takes the Hessians at the current stages and factorises M.
    pub(crate) fn refresh<E: Evaluate<T>>(
        &mut self,
        stages: &Stages<T>,
        energy: &mut E,
        h: T,
        counts: &mut Counts,
    ) -> Result<(), Singular> {
        let (s, n, nnz) = (stages.count(), stages.n, self.pattern.len());
        self.mean.fill(T::int(0));
        for (i, &b) in stages.gauss.weights().iter().enumerate() {
            let entries = &mut self.hessians[i * nnz..][..nnz];
            energy.hessian(&stages.points[i * n..][..n], entries);
            for (x, mean) in entries.iter_mut().zip(&mut self.mean) {
                *x *= h * b;
                *mean += *x;
            }
        }
        counts.hessians += s as u64;
        counts.factorisations += 1;
        let half = T::ratio(1, 2);
        let matrix = self.lu.matrix_mut();
        matrix.fill_with_identity();
        for j in 0..s {
            let entries = &self.hessians[j * nnz..][..nnz];
            for row in 0..n {
                let (r, sign) = turned::<T>(row, n);
                for (position, column) in self.pattern.row(row) {
                    let x = sign * entries[position] * (stages.scale[column] / stages.scale[r]);
                    for i in 0..s {
                        let k = half + stages.u[i * s + j];
                        matrix[(i * n + r, j * n + column)] -= k * x;
                    }
                }
            }
        }
        self.lu.factor()
    }

    /// x ← M⁻¹ x.
    pub(crate) fn solve(&self, x: &mut DVector<T>) {
        self.lu.solve(x);
    }

    /// u = Σ_i B_i x_i, in units of the state: how the end point moves with the stages.
    pub(crate) fn end_displacement(&self, stages: &Stages<T>, x: &DVector<T>, u: &mut [T]) {
        let (n, nnz) = (stages.n, self.pattern.len());
        u.fill(T::int(0));
        for i in 0..stages.count() {
            let entries = &self.hessians[i * nnz..][..nnz];
            for row in 0..n {
                let product = self.pattern.row(row).fold(T::int(0), |sum, (position, j)| {
                    sum + entries[position] * x[i * n + j] * stages.scale[j]
                });
                let (r, sign) = turned::<T>(row, n);
                u[r] += sign * product;
            }
        }
    }

    /// u' = −Ψ⁻¹ u for the step map Ψ linearised at fixed α: how the *start* point moves when the end point is held.
    ///
    /// Ψ = I + Σ B_i (M⁻¹ 1⊗I)_i is symplectic, so Ψ⁻¹ = −J Ψᵀ J: one solve with Mᵀ.
    pub(crate) fn start_displacement(&mut self, stages: &Stages<T>, u: &[T], back: &mut [T]) {
        let (n, nnz) = (stages.n, self.pattern.len());
        // B_iᵀ J u = h b_i ∇²H_i Jᵀ J u = h b_i ∇²H_i u.
        for i in 0..stages.count() {
            let entries = &self.hessians[i * nnz..][..nnz];
            for row in 0..n {
                let product = self.pattern.row(row).fold(T::int(0), |sum, (position, j)| {
                    sum + entries[position] * u[j]
                });
                self.work[i * n + row] = product * stages.scale[row];
            }
        }
        self.lu.solve_transposed(&mut self.work);
        for row in 0..n {
            let sum = (0..stages.count()).fold(T::int(0), |sum, i| sum + self.work[i * n + row]);
            // J Ψᵀ J u = J (J u + Σ_i w_i) = −u + J Σ_i w_i.
            let (r, sign) = turned::<T>(row, n);
            back[r] = sign * sum / stages.scale[row] - u[r];
        }
    }

    /// How far each component is from being resolved by the step: 1 / (1 + ρ_j), where ρ_j = Σ_k |G_jk G_kj| with
    /// G = J Σ_i h b_i ∇²H(Y_i). For an oscillator ρ = (hω)². Independent of the units of q and p, and the same
    /// when the step is made backwards.
    pub(crate) fn resolution(&self, n: usize, weights: &mut [T]) {
        for (j, weight) in weights.iter_mut().enumerate() {
            let (row, _) = turned::<T>(j, n);
            let rho = self.pattern.row(row).fold(T::int(0), |sum, (position, k)| {
                let (partner, _) = turned::<T>(k, n);
                sum + (self.mean[position] * self.mean_entry(partner, j)).abs()
            });
            *weight = T::int(1) / (T::int(1) + rho);
        }
    }

    fn mean_entry(&self, row: usize, column: usize) -> T {
        let range = self.pattern.row_starts[row]..self.pattern.row_starts[row + 1];
        match self.pattern.columns[range.clone()].binary_search(&column) {
            Ok(offset) => self.mean[range.start + offset],
            Err(_) => T::int(0),
        }
    }
}

/// Row `row` of a matrix A stands in row r of J A, with a sign. J = (0 I; −I 0) takes it there and back alike.
fn turned<T: Float>(row: usize, n: usize) -> (usize, T) {
    let m = n / 2;
    if row < m {
        (row + m, -T::int(1))
    } else {
        (row - m, T::int(1))
    }
}
