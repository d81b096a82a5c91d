//! System (7) linearised at the current stages, in full: M = I − K(α)∘(B_1 … B_s) with B_i = h b_i J∇²H(Y_i).
//!
//! All vectors of stages are in units of `Stages::scale`, which makes M independent of the units of q and p. Of wide numbers it is factorised in doubles, and
//! solutions are refined ([`crate::refined`]).
//! Cost: 2/3 (s n)³ operations to factorise, 2 (s n)² for each solve, (s n)² numbers to hold, of wide ones three times as many.

use crate::hessians::{StageHessians, turned};
use crate::linear::{DenseLu, Singular};
use crate::refined::Refined;
use crate::stages::Stages;
use equip_scalar::Float;
use nalgebra::DVector;

#[derive(Debug)]
pub(crate) enum Linearisation<T: Float> {
    Doubles(DenseLu<T>),
    Wide(Refined<T>),
}

impl<T: Float> Linearisation<T> {
    pub(crate) fn new(s: usize, n: usize) -> Self {
        if T::IS_DOUBLE {
            Linearisation::Doubles(DenseLu::new(s * n))
        } else {
            Linearisation::Wide(Refined::new(s * n))
        }
    }

    /// Factorises M.
    pub(crate) fn refresh(
        &mut self,
        stages: &Stages<T>,
        hessians: &StageHessians<T>,
    ) -> Result<(), Singular> {
        match self {
            Linearisation::Doubles(lu) => {
                let matrix = lu.matrix_mut();
                matrix.fill_with_identity();
                each_entry(stages, hessians, |place, x| matrix[place] -= x);
                lu.factor()
            }
            Linearisation::Wide(system) => {
                system.reset();
                each_entry(stages, hessians, |place, x| system.subtract(place, x));
                system.factor()
            }
        }
    }

    /// x ← M⁻¹ x.
    pub(crate) fn solve(&mut self, x: &mut DVector<T>) {
        match self {
            Linearisation::Doubles(lu) => lu.solve(x),
            Linearisation::Wide(system) => system.solve(x, false),
        }
    }

    /// x ← M⁻ᵀ x.
    pub(crate) fn solve_transposed(&mut self, x: &mut DVector<T>) {
        match self {
            Linearisation::Doubles(lu) => lu.solve_transposed(x),
            Linearisation::Wide(system) => system.solve(x, true),
        }
    }
}

/// The entries of K(α)∘(B_1 … B_s) that are not zero, with row and column.
fn each_entry<T: Float>(
    stages: &Stages<T>,
    hessians: &StageHessians<T>,
    mut take: impl FnMut((usize, usize), T),
) {
    let (s, n) = (stages.count(), stages.n);
    let half = T::ratio(1, 2);
    for j in 0..s {
        let entries = hessians.of_stage(j);
        for row in 0..n {
            let (r, sign) = turned::<T>(row, n);
            for (position, column) in hessians.pattern.row(row) {
                let x = sign * entries[position] * (stages.scale[column] / stages.scale[r]);
                for i in 0..s {
                    let k = half + stages.u[i * s + j];
                    take((i * n + r, j * n + column), k * x);
                }
            }
        }
    }
}
