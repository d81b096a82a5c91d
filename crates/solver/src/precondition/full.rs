//! Newton's method, with ∇²H at all stages: M = I − (K(0)_ij B_j), B_j = h b_j J∇²H(Y_j). If T is quadratic,
//! the system for the positions alone is
//!
//! $$ M = I + h\,M_p^{-1} \big[ (K B K)_{ij}\, h b_j \nabla^2 U(Y_j) \big] . $$
//!
//! K is that of α = 0, which is close to K(α) of a step. The reversed step has Kᵀ in its place. All
//! arithmetic is in `f64`: M affects the convergence, not the solution.
//!
//! Cost: 2/3 (s u)³ operations to factorise with u unknown components, 2 (s u)² for each right-hand side.

use crate::precondition::rows::Rows;
use equip_autodiff::{Evaluator, Pattern, turned};
use equip_iterate::{Held, Iterate, Preconditioner, State};
use equip_linear::{DenseLu, Singular};
use equip_scalar::Float;
use equip_tableau::Coefficients;
use nalgebra::{DMatrix, DVector};

/// M with ∇²H at all stages.
#[derive(Debug)]
pub(crate) struct Full {
    /// The layout of the unknown components.
    rows: Rows,
    pattern: Pattern,
    /// K(0), or K B K for the positions alone, and the weights b_i.
    mixing: DMatrix<f64>,
    b: Vec<f64>,
    h: f64,
    /// ∇²H(Y_i) in the order of the pattern, stage by stage.
    hessians: Vec<f64>,
    /// The inverse masses if the positions alone are unknown.
    inverse_masses: Option<Vec<f64>>,
    /// The factorisations with the start held and with the end held.
    lus: [DenseLu<f64>; 2],
    is_factored: [bool; 2],
    x: DVector<f64>,
}

impl Full {
    pub(crate) fn new<T: Float>(
        method: &Coefficients<T>,
        iterate: &Iterate<T>,
        pattern: Pattern,
    ) -> Self {
        let (s, unknown) = (iterate.stages(), iterate.unknowns());
        let k = method.matrix(&vec![T::int(0); method.alphas()]);
        let k = DMatrix::from_row_iterator(s, s, k.iter().map(|k| k.to_f64()));
        let b: Vec<f64> = method.weights().iter().map(|b| b.to_f64()).collect();
        let inverse_masses = iterate.inverse_masses();
        let size = s * unknown;
        Full {
            rows: Rows {
                s,
                stride: iterate.stride(),
                n: unknown,
                units: vec![1.0; unknown],
            },
            mixing: match inverse_masses {
                Some(_) => &k * DMatrix::from_diagonal(&DVector::from_column_slice(&b)) * &k,
                None => k,
            },
            b,
            h: 0.0,
            hessians: vec![0.0; s * pattern.len()],
            inverse_masses: inverse_masses.map(|w| w.iter().map(|w| w.to_f64()).collect()),
            lus: [DenseLu::new(size), DenseLu::new(size)],
            is_factored: [false; 2],
            x: DVector::zeros(size),
            pattern,
        }
    }

    /// Evaluates ∇²H at the stages of a step of size `h` from `y`, and factorises M with the start held. M
    /// with the end held is factorised on first use.
    pub(crate) fn linearise<T: Float>(
        &mut self,
        iterate: &Iterate<T>,
        energy: &mut Evaluator<T>,
        (y, h): (&State<T>, T),
        (state, entries): (&mut [T], &mut [T]),
    ) -> Result<(), Singular> {
        self.h = h.to_f64();
        for (unit, &scale) in self.rows.units.iter_mut().zip(iterate.scale()) {
            *unit = scale.to_f64();
        }
        self.is_factored = [false; 2];
        let count = entries.len();
        for i in 0..self.rows.s {
            for (c, x) in state.iter_mut().enumerate() {
                // For T(p) + U(q) with quadratic T, the momenta do not enter ∇²U.
                *x = if c < self.rows.n {
                    iterate.points()[c * self.rows.stride + i]
                } else {
                    y.hi[c]
                };
            }
            energy.hessian(state, entries);
            let to = self.hessians[i * count..][..count].iter_mut();
            to.zip(&*entries).for_each(|(to, x)| *to = x.to_f64());
        }
        self.factor(Held::Start)
    }

    /// Whether ∇²H is finite at all stages.
    pub(crate) fn is_finite(&self) -> bool {
        self.hessians.iter().all(|x| x.is_finite())
    }

    /// Factorises M. If the end is held, K is that of the reversed step, with reversed stages and −h.
    fn factor(&mut self, held: Held) -> Result<(), Singular> {
        let (s, n, nnz) = (self.rows.s, self.rows.n, self.pattern.len());
        let units = &self.rows.units;
        let stage = |i: usize| if held == Held::Start { i } else { s - 1 - i };
        let sign = if held == Held::Start { 1.0 } else { -1.0 };
        let lu = &mut self.lus[held as usize];
        let matrix = lu.matrix_mut();
        matrix.fill_with_identity();
        for j in 0..s {
            let entries = &self.hessians[stage(j) * nnz..][..nnz];
            for row in 0..n {
                let (to, factor) = match &self.inverse_masses {
                    Some(w) => (row, -self.h * self.h * w[row]),
                    None => {
                        let (to, turn) = turned::<f64>(row, n);
                        (to, sign * turn * self.h)
                    }
                };
                let columns = self.pattern.row(row);
                for (position, column) in columns.take_while(|&(_, column)| column < n) {
                    let x = factor * self.b[j] * entries[position] * (units[column] / units[to]);
                    for i in 0..s {
                        matrix[(i * n + to, j * n + column)] -= self.mixing[(i, j)] * x;
                    }
                }
            }
        }
        self.is_factored[held as usize] = lu.factor().is_ok();
        if self.is_factored[held as usize] {
            Ok(())
        } else {
            Err(Singular)
        }
    }
}

impl<T: Float> Preconditioner<T> for Full {
    fn apply(&mut self, held: Held, rows: &mut [T]) {
        if !self.is_factored[held as usize] && self.factor(held).is_err() {
            // The iteration continues with M = 1; its contraction shows whether that suffices.
            return;
        }
        if let Some(size) = self.rows.gather(held, rows, self.x.as_mut_slice()) {
            self.lus[held as usize].solve(&mut self.x);
            self.rows.scatter(held, self.x.as_slice(), size, rows);
        }
    }
}
