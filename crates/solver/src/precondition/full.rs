//! ∇²H at all stages (Newton): M = I − K(0)∘(B_1 … B_s), B_i = h b_i J∇²H(Y_i), or, where T is quadratic, of
//! the positions alone
//!
//! $$ M = I + h\,M_p^{-1} \big[ (K B K)_{ij}\, h b_j \nabla^2 U(Y_j) \big] . $$
//!
//! K is that of α = 0, which the α's of a step are near. The step made backwards has Kᵀ in its place.
//! Everything is in doubles: M decides how fast the solution is found, not which.
//!
//! Cost: 2/3 (s u)³ operations to factorise for u unknown components, 2 (s u)² for each right-hand side.

use crate::precondition::rows::Rows;
use equip_autodiff::{Evaluate, Pattern};
use equip_linear::{DenseLu, Singular};
use equip_scalar::Float;
use equip_sweeps::{Held, Iterate, Preconditioner, State, turned};
use equip_tableau::Gauss;
use nalgebra::{DMatrix, DVector};

/// M of ∇²H at all stages.
#[derive(Debug)]
pub(crate) struct Full {
    rows: Rows,
    pattern: Pattern,
    /// K(0), and the weights b_i.
    k: DMatrix<f64>,
    b: Vec<f64>,
    h: f64,
    /// ∇²H(Y_i) in the order of the pattern, stage by stage.
    hessians: Vec<f64>,
    /// 1 over the masses where the positions alone are unknown.
    inverse_masses: Option<Vec<f64>>,
    /// All components, and the positions alone; from the start of the step, and from its end.
    lus: [[DenseLu<f64>; 2]; 2],
    is_factored: [[bool; 2]; 2],
    work: Vec<f64>,
    x: [DVector<f64>; 2],
}

impl Full {
    pub(crate) fn new<T: Float>(gauss: &Gauss<T>, iterate: &Iterate<T>, pattern: Pattern) -> Self {
        let (s, n) = (iterate.stages(), iterate.components());
        let mut k = vec![T::int(0); s * s];
        gauss.skew_into(&vec![T::int(0); s - 1], &mut k);
        let inverse_masses = iterate.inverse_masses();
        let size = |unknown: usize| DenseLu::new(s * unknown);
        let alone = if inverse_masses.is_some() { n / 2 } else { 0 };
        Full {
            rows: Rows {
                s,
                stride: iterate.stride(),
                n,
                units: vec![1.0; n],
            },
            k: DMatrix::from_fn(s, s, |i, j| k[i * s + j].to_f64()),
            b: gauss.weights().iter().map(|b| b.to_f64()).collect(),
            h: 0.0,
            hessians: vec![0.0; s * pattern.len()],
            inverse_masses: inverse_masses.map(|w| w.iter().map(|w| w.to_f64()).collect()),
            lus: [[size(n), size(n)], [size(alone), size(alone)]],
            is_factored: [[false; 2]; 2],
            work: vec![0.0; s * n],
            x: [n, n / 2].map(|unknown| DVector::zeros(s * unknown)),
            pattern,
        }
    }

    /// Takes ∇²H at the stages of a step of size `h` from `y`, and factorises M of the components that are
    /// unknown; of all of them, and from the end of the step, it is factorised when it is asked for.
    pub(crate) fn linearise<T: Float, E: Evaluate<T>>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut E,
        (y, h): (&State<T>, T),
        (state, entries): (&mut [T], &mut [T]),
    ) -> Result<(), Singular> {
        self.h = h.to_f64();
        for (unit, &scale) in self.rows.units.iter_mut().zip(iterate.scale()) {
            *unit = scale.to_f64();
        }
        self.is_factored = [[false; 2]; 2];
        let unknown = iterate.unknowns();
        for (i, to) in self.hessians.chunks_exact_mut(entries.len()).enumerate() {
            for (c, x) in state.iter_mut().enumerate() {
                // Of T(p) + U(q), T quadratic, the momenta do not enter.
                *x = if c < unknown {
                    iterate.points()[c * self.rows.stride + i]
                } else {
                    y.hi[c]
                };
            }
            energy.hessian(state, entries);
            to.iter_mut()
                .zip(&*entries)
                .for_each(|(to, x)| *to = x.to_f64());
        }
        let alone = unknown < self.rows.n;
        self.factor(alone, Held::Start)?;
        self.is_factored[usize::from(alone)][Held::Start as usize] = true;
        Ok(())
    }

    /// K or, where the end is held, the K of the step made backwards, with its stages and its −h.
    fn factor(&mut self, alone: bool, held: Held) -> Result<(), Singular> {
        let (s, n, nnz) = (self.rows.s, self.rows.n, self.pattern.len());
        let units = &self.rows.units;
        let stage = |i: usize| if held == Held::Start { i } else { s - 1 - i };
        let sign = if held == Held::Start { 1.0 } else { -1.0 };
        let lu = &mut self.lus[usize::from(alone)][held as usize];
        let matrix = lu.matrix_mut();
        matrix.fill_with_identity();
        if let (true, Some(w)) = (alone, &self.inverse_masses) {
            let m = n / 2;
            let twofold =
                &self.k * DMatrix::from_diagonal(&DVector::from_column_slice(&self.b)) * &self.k;
            for j in 0..s {
                let entries = &self.hessians[stage(j) * nnz..][..nnz];
                for row in 0..m {
                    for (position, column) in
                        self.pattern.row(row).take_while(|&(_, column)| column < m)
                    {
                        let x = self.h * self.h * self.b[j] * w[row] * entries[position];
                        let x = x * (units[column] / units[row]);
                        for i in 0..s {
                            matrix[(i * m + row, j * m + column)] += twofold[(i, j)] * x;
                        }
                    }
                }
            }
        } else {
            for j in 0..s {
                let entries = &self.hessians[stage(j) * nnz..][..nnz];
                for row in 0..n {
                    let (r, turn) = turned::<f64>(row, n);
                    for (position, column) in self.pattern.row(row) {
                        let x = sign * turn * self.h * self.b[j] * entries[position];
                        let x = x * (units[column] / units[r]);
                        for i in 0..s {
                            matrix[(i * n + r, j * n + column)] -= self.k[(i, j)] * x;
                        }
                    }
                }
            }
        }
        lu.factor()
    }
}

impl<T: Float> Preconditioner<T> for Full {
    fn apply(&mut self, held: Held, rows: &mut [T], sides: usize) {
        let (s, n) = (self.rows.s, self.rows.n);
        let unknown = rows.len() / (sides * self.rows.stride);
        let alone = unknown < n;
        let is_factored = &mut self.is_factored[usize::from(alone)][held as usize];
        if !std::mem::replace(is_factored, true) && self.factor(alone, held).is_err() {
            // The iteration goes on with M = 1, and tells by its contraction.
            self.is_factored[usize::from(alone)][held as usize] = false;
            return;
        }
        for side in 0..sides {
            let Some(size) = self.rows.gather(held, rows, (side, sides), &mut self.work) else {
                continue;
            };
            let x = &mut self.x[usize::from(alone)];
            for i in 0..s {
                let from = &self.work[i * n..][..unknown];
                x.as_mut_slice()[i * unknown..][..unknown].copy_from_slice(from);
            }
            self.lus[usize::from(alone)][held as usize].solve(x);
            for i in 0..s {
                let to = &mut self.work[i * n..][..unknown];
                to.copy_from_slice(&x.as_slice()[i * unknown..][..unknown]);
            }
            self.rows
                .scatter(held, &self.work, size, rows, (side, sides));
        }
    }
}
