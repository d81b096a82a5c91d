//! System (7) linearised with one Hessian H̄ for all stages and α = 0: M̃ = I − h A⊗JH̄ in place of M.
//!
//! H̄ is taken at the mean of the stages Σ b_i Y_i. M̃ falls apart into ⌈s/2⌉ systems of size n ([`crate::splitting`],
//! [`crate::shifted`]). Corrections with it contract by a factor θ, about h times the variation of ∇²H over the step plus |α|; the solution
//! is that of the equations, whatever H̄ is.
//!
//! *Precision.* M̃ is made, factorised and solved with in f64 whatever the float type is: right-hand sides are divided by their
//! largest component and M̃ is in units of the state, so f64 has the range. Residuals stay in `T`.
//!
//! Cost: one Hessian and ⌈s/2⌉ factorisations to refresh; each solve ⌈s/2⌉ solves and 4 s² n operations.

use crate::checkpoint::{Exact, SolverMemory};
use crate::error::IntegrateError;
use crate::hessians::turned;
use crate::linear::Singular;
use crate::outcome::Counts;
use crate::shifted::ShiftedSystems;
use crate::splitting::Splitting;
use crate::stages::Stages;
use equip_autodiff::{Evaluate, Structure};
use equip_scalar::Float;
use nalgebra::{Complex, DMatrix, DVector};

/// A component that has grown or shrunk by this makes for badly scaled factors.
const MOST_RESCALED: f64 = 1e6;

#[derive(Debug)]
pub(crate) struct Simplified<T: Float> {
    splitting: Splitting,
    systems: ShiftedSystems,
    /// h H̄, entries in the order of the pattern.
    hessian: Vec<T>,
    /// Units of the state that M̃ was made in, and those of now relative to them.
    unit: Vec<T>,
    ratio: Vec<f64>,
    /// Σ b_i Y_i, later Σ b_i x_i.
    middle: Vec<T>,
    /// Right-hand sides, solutions and G times the solutions, row by row of the Schur form.
    rhs: Vec<f64>,
    solution: Vec<f64>,
    turned: Vec<f64>,
    pair: Vec<Complex<f64>>,
}

impl<T: Float> Simplified<T> {
    /// `None` if the tableau cannot be split.
    pub(crate) fn new(s: usize, structure: &Structure) -> Option<Self> {
        let splitting = Splitting::new(s)?;
        let pattern = structure.hessian.to_pattern();
        let n = pattern.dimension();
        Some(Simplified {
            hessian: vec![T::int(0); pattern.len()],
            systems: ShiftedSystems::new(pattern, structure.separable, splitting.blocks.len()),
            unit: vec![T::int(1); n],
            ratio: vec![1.0; n],
            middle: vec![T::int(0); n],
            rhs: vec![0.0; s * n],
            solution: vec![0.0; s * n],
            turned: vec![0.0; s * n],
            pair: vec![Complex::new(0.0, 0.0); n],
            splitting,
        })
    }

    /// Takes H̄ at the current stages and factorises M̃.
    pub(crate) fn refresh<E: Evaluate<T>>(
        &mut self,
        stages: &Stages<T>,
        energy: &mut E,
        h: T,
        counts: &mut Counts,
    ) -> Result<(), Singular> {
        let n = stages.n;
        weighted_mean(stages, &stages.points, &mut self.middle);
        energy.hessian(&self.middle, &mut self.hessian);
        counts.hessians += 1;
        counts.refreshes += 1;
        self.unit.copy_from_slice(&stages.scale);
        let (pattern, g) = self.systems.generator_mut();
        for row in 0..n {
            let (r, sign) = turned::<T>(row, n);
            for (position, column) in pattern.row(row) {
                self.hessian[position] *= h;
                let x = self.hessian[position] * (self.unit[column] / self.unit[r]);
                g[position] = (sign * x).to_f64();
            }
        }
        counts.simplified_factorisations += self.splitting.blocks.len() as u64;
        self.systems.factor(&self.splitting.blocks)
    }

    /// What M̃ is made of, for a checkpoint.
    pub(crate) fn save(&self, memory: &mut SolverMemory) {
        memory.hessian = Exact::all(&self.hessian);
        memory.unit = Exact::all(&self.unit);
        memory.generator = Exact::all(self.systems.generator());
    }

    /// M̃ as it was when it was saved.
    pub(crate) fn restore(&mut self, memory: &SolverMemory) -> Result<(), IntegrateError<T>> {
        let what = "the Hessian of simplified Newton";
        let damaged = || IntegrateError::CheckpointDamaged { what };
        Exact::read_all(&memory.hessian, &mut self.hessian, what)?;
        Exact::read_all(&memory.unit, &mut self.unit, what)?;
        let (_, generator) = self.systems.generator_mut();
        Exact::read_all(&memory.generator, generator, what).map_err(|_| damaged())?;
        self.systems
            .factor(&self.splitting.blocks)
            .map_err(|_| damaged())
    }

    /// To be called when `Stages::scale` may have changed. Returns whether M̃ in its old units still serves.
    pub(crate) fn rescale(&mut self, stages: &Stages<T>) -> bool {
        let units = stages.scale.iter().zip(&self.unit);
        for (ratio, (&now, &then)) in self.ratio.iter_mut().zip(units) {
            *ratio = (now / then).to_f64();
        }
        self.ratio
            .iter()
            .all(|r| (1.0 / MOST_RESCALED..MOST_RESCALED).contains(r))
    }

    /// x ← M̃⁻¹ x.
    pub(crate) fn solve(&mut self, x: &mut DVector<T>) {
        let Some(size) = self.load(x, false) else {
            return;
        };
        mix(&self.splitting.left, false, &self.solution, &mut self.rhs);
        for j in (0..self.splitting.blocks.len()).rev() {
            self.solve_block(j, false);
        }
        mix(&self.splitting.right, false, &self.solution, &mut self.rhs);
        self.unload(x, size, false);
    }

    /// x ← M̃⁻ᵀ x.
    pub(crate) fn solve_transposed(&mut self, x: &mut DVector<T>) {
        let Some(size) = self.load(x, true) else {
            return;
        };
        mix(&self.splitting.right, true, &self.solution, &mut self.rhs);
        for j in 0..self.splitting.blocks.len() {
            self.solve_block(j, true);
        }
        mix(&self.splitting.left, true, &self.solution, &mut self.rhs);
        self.unload(x, size, true);
    }

    /// u = h JH̄ Σ_i b_i x_i, in units of the state: about how the end point moves with the stages.
    pub(crate) fn end_displacement(&mut self, stages: &Stages<T>, x: &DVector<T>, u: &mut [T]) {
        let n = stages.n;
        weighted_mean(stages, x.as_slice(), &mut self.middle);
        let (pattern, _) = self.systems.generator_mut();
        for row in 0..n {
            let product = pattern.row(row).fold(T::int(0), |sum, (position, j)| {
                sum + self.hessian[position] * self.middle[j] * stages.scale[j]
            });
            let (r, sign) = turned::<T>(row, n);
            u[r] = sign * product;
        }
    }

    /// x in f64 and in the units of M̃ into `solution`, divided by its size, which is returned; `None` leaves x as it is.
    fn load(&mut self, x: &DVector<T>, transposed: bool) -> Option<T> {
        let size = x.amax();
        if size == T::int(0) || !size.is_finite() {
            return None;
        }
        let n = self.ratio.len();
        let blocks = self.solution.chunks_exact_mut(n);
        for (out, x) in blocks.zip(x.as_slice().chunks_exact(n)) {
            for j in 0..n {
                let value = (x[j] / size).to_f64();
                out[j] = if transposed {
                    value / self.ratio[j]
                } else {
                    value * self.ratio[j]
                };
            }
        }
        Some(size)
    }

    fn unload(&self, x: &mut DVector<T>, size: T, transposed: bool) {
        let n = self.ratio.len();
        let blocks = self.rhs.chunks_exact(n);
        for (value, x) in blocks.zip(x.as_mut_slice().chunks_exact_mut(n)) {
            for j in 0..n {
                let value = if transposed {
                    value[j] * self.ratio[j]
                } else {
                    value[j] / self.ratio[j]
                };
                x[j] = T::exact(value) * size;
            }
        }
    }

    /// Solves for the rows of block j, those after it (before it, if transposed) being known.
    fn solve_block(&mut self, j: usize, transposed: bool) {
        let n = self.ratio.len();
        let s = self.splitting.schur.nrows();
        let block = self.splitting.blocks[j];
        let (start, end) = (block.start, block.start + block.size);
        let known = if transposed { 0..start } else { end..s };
        for row in start..end {
            let rhs = &mut self.rhs[row * n..][..n];
            for k in known.clone() {
                let c = if transposed {
                    self.splitting.schur[(k, row)]
                } else {
                    self.splitting.schur[(row, k)]
                };
                let turned = &self.turned[k * n..][..n];
                rhs.iter_mut()
                    .zip(turned)
                    .for_each(|(sum, &x)| *sum += c * x);
            }
        }
        let eta = if transposed { block.zeta } else { block.eta };
        let (first, second) = self.rhs[start * n..end * n].split_at(n);
        for (i, v) in self.pair.iter_mut().enumerate() {
            *v = first[i].into();
            if let Some(&x) = second.get(i) {
                *v += eta * x;
            }
        }
        self.systems.solve(j, &block, &mut self.pair, transposed);
        let (first, second) = self.solution[start * n..end * n].split_at_mut(n);
        for (i, v) in self.pair.iter().enumerate() {
            first[i] = v.re;
            if let Some(w) = second.get_mut(i) {
                *w = v.im / eta.im;
                first[i] -= eta.re * *w;
            }
        }
        for row in start..end {
            let (x, out) = (
                &self.solution[row * n..][..n],
                &mut self.turned[row * n..][..n],
            );
            self.systems.apply(x, out, transposed);
        }
    }
}

/// Σ_i b_i x_i.
fn weighted_mean<T: Float>(stages: &Stages<T>, x: &[T], mean: &mut [T]) {
    mean.fill(T::int(0));
    for (&b, x) in stages.gauss.weights().iter().zip(x.chunks_exact(stages.n)) {
        mean.iter_mut().zip(x).for_each(|(sum, &x)| *sum += b * x);
    }
}

/// out = (C⊗I) x, or with Cᵀ.
fn mix(c: &DMatrix<f64>, transposed: bool, x: &[f64], out: &mut [f64]) {
    let s = c.nrows();
    let n = x.len() / s;
    for (i, out) in out.chunks_exact_mut(n).enumerate() {
        out.fill(0.0);
        for (k, x) in x.chunks_exact(n).enumerate() {
            let c = if transposed { c[(k, i)] } else { c[(i, k)] };
            out.iter_mut().zip(x).for_each(|(sum, &x)| *sum += c * x);
        }
    }
}
