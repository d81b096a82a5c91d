//! System (7) linearised at the current stages, in full: M = I − K(α)∘(B_1 … B_s) with B_i = h b_i J∇²H(Y_i).
//!
//! All vectors of stages are in units of `Stages::scale`, which makes M independent of the units of q and p.
//! Cost: 2/3 (s n)³ operations to factorise, 2 (s n)² for each solve, (s n)² numbers to hold.

use crate::hessians::{StageHessians, turned};
use crate::linear::{DenseLu, Singular};
use crate::stages::Stages;
use equip_scalar::Float;
use nalgebra::DVector;

#[derive(Debug)]
pub(crate) struct Linearisation<T: Float> {
    lu: DenseLu<T>,
}

impl<T: Float> Linearisation<T> {
    pub(crate) fn new(s: usize, n: usize) -> Self {
        Linearisation {
            lu: DenseLu::new(s * n),
        }
    }

    /// Factorises M.
    pub(crate) fn refresh(
        &mut self,
        stages: &Stages<T>,
        hessians: &StageHessians<T>,
    ) -> Result<(), Singular> {
        let (s, n) = (stages.count(), stages.n);
        let half = T::ratio(1, 2);
        let matrix = self.lu.matrix_mut();
        matrix.fill_with_identity();
        for j in 0..s {
            let entries = hessians.of_stage(j);
            for row in 0..n {
                let (r, sign) = turned::<T>(row, n);
                for (position, column) in hessians.pattern.row(row) {
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

    /// x ← M⁻ᵀ x.
    pub(crate) fn solve_transposed(&self, x: &mut DVector<T>) {
        self.lu.solve_transposed(x);
    }
}
