//! Full Newton on system (7): stages Z and the free α's together, by block elimination.
//!
//! Linearising  Z − K(α) L(Z) = 0,  H(y0 + Σ L_i) − H_ref = 0  gives the bordered system
//!
//! $$ M\,\delta Z - \sum_k (T_k L)\,\delta\alpha_k = -R, \qquad
//!    \nabla H(y_1)^T \sum_i B_i\,\delta Z_i = -g, $$
//!
//! with B_i = h b_i J∇²H(Y_i) and M = I − K(α)∘(B_1 … B_s). One factorisation of M serves the solves for −R and for
//! every T_k L; the α's follow from one scalar equation ([`crate::alpha`]).
//!
//! At Z = 0 all T_k L vanish and the border is singular, and while the stages are far from their solution g says
//! nothing yet: an α moves only when the predicted |g| stands out of the error that the stages still have.
//!
//! Cost per iteration: s Hessians, 2/3 (s n)³ operations for the factorisation, 2 (s n)² for each of up to s solves.
//! Once a correction is below ε^(1/3) the factorisation is kept: the next correction is at round-off with either.

use crate::alpha::{AlphaMove, Moved};
use crate::energy::{Residual, Target};
use crate::linear::DenseLu;
use crate::outcome::Counts;
use crate::stages::Stages;
use crate::state::State;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::Float;
use nalgebra::DMatrix;

/// Corrections this many ε are as small as rounding lets them become.
const CONVERGED: i64 = 4;
/// Corrections that stagnate below this many ε are accepted as round-off.
const STAGNATED: i64 = 4096;
/// Energy defects that stagnate below this many floors are accepted as round-off.
const ENERGY_STAGNATED: i64 = 4;
/// α's shortened by their bound this often in one step: no admissible α.
const MAX_SHORTENED: u32 = 3;

/// Why the stages of a step were not found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Failure<T> {
    NotFinite,
    Singular,
    NoConvergence { iterations: u32, correction: T },
    NoAlpha,
}

/// What is fixed while a step is solved.
#[derive(Debug)]
pub(crate) struct StepTask<'a, T> {
    pub(crate) y: &'a State<T>,
    pub(crate) h: T,
    /// The energy to reach; `None` holds the α's where they are.
    pub(crate) target: Option<Target<T>>,
    /// Free are α_first … α_{s−1}.
    pub(crate) first: usize,
    pub(crate) alpha_bound: T,
    pub(crate) max_iterations: u32,
    /// Factor anew in every iteration, whatever the size of the correction.
    pub(crate) pure: bool,
}

/// One Newton iteration, as it is seen before its correction is applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonRecord<T> {
    /// Correction of the stages that −R asks for, relative to the state: the error of the stages.
    pub correction: T,
    /// g = H(y1) − H_ref; zero when the energy is not asked for.
    pub energy_defect: T,
}

#[derive(Debug)]
pub(crate) struct Newton<T: Float> {
    lu: DenseLu<T>,
    pattern: Pattern,
    /// h b_i ∇²H(Y_i), entries in the order of the pattern, stage by stage.
    hessians: Vec<T>,
    /// Column 0: −R, then δZ at fixed α. Column k ≥ 1: T_k L, then ∂Z/∂α_k. Rows in units of `Stages::scale`.
    columns: DMatrix<T>,
    alpha_move: AlphaMove<T>,
    moved_end: Vec<T>,
    increments: Vec<T>,
    /// Iterations of the step solved last.
    pub(crate) history: Vec<NewtonRecord<T>>,
}

impl<T: Float> Newton<T> {
    pub(crate) fn new(s: usize, pattern: Pattern, max_iterations: u32) -> Self {
        let n = pattern.dimension();
        Newton {
            lu: DenseLu::new(s * n),
            hessians: vec![T::int(0); s * pattern.len()],
            columns: DMatrix::zeros(s * n, s),
            alpha_move: AlphaMove::new(s - 1),
            moved_end: vec![T::int(0); n],
            increments: vec![T::int(0); s * n],
            history: Vec::with_capacity(max_iterations as usize),
            pattern,
        }
    }

    /// Solves for Z (and the α's, if there is a target) from the guess in `stages`; on success `stages` holds the
    /// solution with its L, `next` the end point and `residual` its energy.
    pub(crate) fn solve<E: Evaluate<T>>(
        &mut self,
        stages: &mut Stages<T>,
        residual: &mut Residual<T>,
        next: &mut State<T>,
        energy: &mut E,
        task: &StepTask<'_, T>,
        counts: &mut Counts,
    ) -> Result<(), Failure<T>> {
        let eps = T::EPSILON;
        let reuse = eps.cbrt();
        let (mut last, mut last_defect) = (T::INFINITY, T::INFINITY);
        let mut shortened = 0;
        self.history.clear();
        finite(stages.evaluate(energy, task.y, task.h, counts))?;
        for _ in 0..task.max_iterations {
            counts.newton_iterations += 1;
            task.y.advance(&stages.l, next);
            let mut free = 0;
            if let Some(target) = task.target {
                counts.gradients += 1;
                finite(residual.evaluate(energy, next, target))?;
                if residual.defect.abs() > residual.floor {
                    free = stages.count() - task.first;
                }
            }
            if last > reuse || task.pure {
                stages.measure(task.y);
                self.linearise(stages, energy, task.h, counts)?;
            }
            self.solve_columns(stages, free, task.first, counts);
            let correction = self.columns.column(0).amax();
            finite(correction.is_finite())?;
            let defect = if task.target.is_some() {
                residual.defect
            } else {
                T::int(0)
            };
            self.history.push(NewtonRecord {
                correction,
                energy_defect: defect,
            });

            let stagnates = correction > last / T::int(4) && correction <= T::int(STAGNATED) * eps;
            if correction <= T::int(CONVERGED) * eps || stagnates {
                if free == 0 {
                    return Ok(());
                }
                let small = defect.abs() <= T::int(ENERGY_STAGNATED) * residual.floor;
                if small && defect.abs() > last_defect / T::int(2) {
                    return Ok(());
                }
                last_defect = defect.abs();
            }

            if free > 0 {
                match self.move_alphas(stages, residual, task, correction) {
                    Some(Moved::ToBound) => {
                        shortened += 1;
                        if shortened == MAX_SHORTENED {
                            return Err(Failure::NoAlpha);
                        }
                    }
                    Some(Moved::NotAtAll) if correction <= reuse => return Err(Failure::NoAlpha),
                    _ => {}
                }
            }
            last = self.columns.column(0).amax();
            let n = stages.n;
            for (k, z) in stages.z.iter_mut().enumerate() {
                *z += self.columns[k] * stages.scale[k % n];
            }
            finite(stages.evaluate(energy, task.y, task.h, counts))?;
        }
        if task.target.is_some() && last <= reuse {
            return Err(Failure::NoAlpha);
        }
        Err(Failure::NoConvergence {
            iterations: task.max_iterations,
            correction: last,
        })
    }

    /// M at the current stages, in units of the state, factorised.
    fn linearise<E: Evaluate<T>>(
        &mut self,
        stages: &Stages<T>,
        energy: &mut E,
        h: T,
        counts: &mut Counts,
    ) -> Result<(), Failure<T>> {
        let (s, n, m) = (stages.count(), stages.n, stages.n / 2);
        let half = T::ratio(1, 2);
        let points = stages.points.chunks_exact(n);
        let blocks = self.hessians.chunks_exact_mut(self.pattern.len().max(1));
        for ((y, entries), &b) in points.zip(blocks).zip(stages.gauss.weights()) {
            energy.hessian(y, entries);
            entries.iter_mut().for_each(|x| *x *= h * b);
        }
        counts.hessians += s as u64;
        counts.factorisations += 1;
        let matrix = self.lu.matrix_mut();
        matrix.fill_with_identity();
        for (j, entries) in self
            .hessians
            .chunks_exact(self.pattern.len().max(1))
            .enumerate()
        {
            for row in 0..n {
                // Row `row` of ∇²H lands in row r of J∇²H, with a sign.
                let (r, sign) = if row < m {
                    (row + m, -T::int(1))
                } else {
                    (row - m, T::int(1))
                };
                for (position, column) in self.pattern.row(row) {
                    let x = sign * entries[position] * (stages.scale[column] / stages.scale[r]);
                    for i in 0..s {
                        let k = half + stages.u[i * s + j];
                        matrix[(i * n + r, j * n + column)] -= k * x;
                    }
                }
            }
        }
        self.lu.factor().map_err(|_| Failure::Singular)
    }

    /// Solves for −R and, with `free` > 0, for the T_k L of the free α's.
    fn solve_columns(
        &mut self,
        stages: &Stages<T>,
        free: usize,
        first: usize,
        counts: &mut Counts,
    ) {
        let n = stages.n;
        stages.increments(&mut self.increments);
        for (k, (&kl, &z)) in self.increments.iter().zip(&stages.z).enumerate() {
            self.columns[(k, 0)] = (kl - z) / stages.scale[k % n];
        }
        for column in 1..=free {
            stages.alpha_derivative(first + column - 1, &mut self.increments);
            for (k, &x) in self.increments.iter().enumerate() {
                self.columns[(k, column)] = x / stages.scale[k % n];
            }
        }
        counts.alpha_solves += free as u64;
        self.lu.solve(&mut self.columns, 1 + free);
    }

    /// Moves the free α's if the predicted defect stands out of the error of the stages, and adds their part to
    /// the correction in column 0.
    fn move_alphas(
        &mut self,
        stages: &mut Stages<T>,
        residual: &Residual<T>,
        task: &StepTask<'_, T>,
        correction: T,
    ) -> Option<Moved> {
        self.end_displacement(stages, 0);
        let g = residual.defect + dot(&residual.gradient, &self.moved_end);
        let uncertain = T::int(4) * residual.energy_scale() * correction * correction;
        if !(g.abs() > residual.floor.max(uncertain)) {
            return None;
        }
        let free = stages.count() - task.first;
        for column in 1..=free {
            self.end_displacement(stages, column);
            let alpha = task.first + column - 2;
            self.alpha_move.slopes[alpha] = dot(&residual.gradient, &self.moved_end);
            self.alpha_move.displacements[alpha] = stages.relative_size(&self.moved_end);
        }
        let moved =
            self.alpha_move
                .least_displacement(g, &stages.alphas, task.first, task.alpha_bound);
        for column in 1..=free {
            let delta = self.alpha_move.delta[task.first + column - 2];
            if delta != T::int(0) {
                for k in 0..self.columns.nrows() {
                    let x = self.columns[(k, column)];
                    self.columns[(k, 0)] += delta * x;
                }
            }
        }
        stages.move_alphas(&self.alpha_move.delta);
        Some(moved)
    }

    /// Σ_i B_i δZ_i for the δZ in the given column: how the end point moves with it.
    fn end_displacement(&mut self, stages: &Stages<T>, column: usize) {
        let (n, m) = (stages.n, stages.n / 2);
        let nnz = self.pattern.len().max(1);
        self.moved_end.fill(T::int(0));
        for (i, entries) in self.hessians.chunks_exact(nnz).enumerate() {
            for row in 0..n {
                let product = self.pattern.row(row).fold(T::int(0), |sum, (position, j)| {
                    sum + entries[position] * self.columns[(i * n + j, column)] * stages.scale[j]
                });
                if row < m {
                    self.moved_end[row + m] -= product;
                } else {
                    self.moved_end[row - m] += product;
                }
            }
        }
    }
}

fn finite<T>(ok: bool) -> Result<(), Failure<T>> {
    if ok { Ok(()) } else { Err(Failure::NotFinite) }
}

fn dot<T: Float>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::int(0), |sum, (&x, &y)| sum + x * y)
}
