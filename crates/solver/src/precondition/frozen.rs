//! One ∇²H for all stages (simplified Newton): M = I − h (A ⊗ J H̄), A = K(0) B.
//!
//! With the real Schur form A = R S L ([`crate::precondition::schur`]) the system falls apart into one for
//! each eigenvalue of A, complex and of size 2m, or m where H is separable
//! ([`crate::precondition::shifted_systems`]). The step made backwards has the same with −h.
//!
//! Everything is in doubles: M decides how fast the solution is found, not which. Why not in real arithmetic:
//! docs/adr/0032.
//!
//! Cost: ⌈s/2⌉ factorisations, a solve with each for every right-hand side.

use crate::precondition::rows::Rows;
use crate::precondition::schur::Schur;
use crate::precondition::shifted_systems::ShiftedSystems;
use equip_autodiff::{Structure, turned};
use equip_iterate::{Held, Iterate, Preconditioner};
use equip_linear::Singular;
use equip_scalar::Float;
use equip_tableau::Coefficients;
use nalgebra::{Complex, DMatrix};

/// M of one ∇²H.
#[derive(Debug)]
pub(crate) struct Frozen {
    rows: Rows,
    schur: Schur,
    /// For the step from its start, and from its end; that is factorised at the first use.
    systems: [ShiftedSystems; 2],
    has_backward: bool,
    /// Right-hand sides, solutions and G times the solutions, row by row of the Schur form.
    rhs: Vec<f64>,
    solution: Vec<f64>,
    turned: Vec<f64>,
    pair: Vec<Complex<f64>>,
}

impl Frozen {
    /// `None` if the tableau cannot be split.
    pub(crate) fn new<T: Float>(
        method: &Coefficients<T>,
        iterate: &Iterate<T>,
        structure: &Structure,
    ) -> Option<Self> {
        let (s, n) = (iterate.stages(), iterate.components());
        let schur = Schur::new(method)?;
        let systems = || {
            let pattern = structure.hessian.to_pattern();
            ShiftedSystems::new(pattern, structure.separable, schur.blocks.len())
        };
        Some(Frozen {
            rows: Rows {
                s,
                stride: iterate.stride(),
                n,
                units: vec![1.0; n],
            },
            systems: [systems(), systems()],
            has_backward: false,
            rhs: vec![0.0; s * n],
            solution: vec![0.0; s * n],
            turned: vec![0.0; s * n],
            pair: vec![Complex::new(0.0, 0.0); n],
            schur,
        })
    }

    /// Factorises M of this ∇²H, entries in the order of its pattern, for a step of size `h` with components
    /// of these sizes. Returns how many systems that were.
    pub(crate) fn factor<T: Float>(
        &mut self,
        hessian: &[T],
        h: T,
        scale: &[T],
    ) -> Result<u64, Singular> {
        for (unit, &scale) in self.rows.units.iter_mut().zip(scale) {
            *unit = scale.to_f64();
        }
        let (n, units) = (self.rows.n, &self.rows.units);
        for (systems, h) in self.systems.iter_mut().zip([h, -h]) {
            let (pattern, g) = systems.generator_mut();
            for row in 0..n {
                let (r, sign) = turned::<f64>(row, n);
                for (position, column) in pattern.row(row) {
                    let x = (h * hessian[position]).to_f64();
                    g[position] = sign * x * (units[column] / units[r]);
                }
            }
        }
        self.has_backward = false;
        self.systems[0].factor(&self.schur.blocks)?;
        Ok(self.schur.blocks.len() as u64)
    }

    /// The entries of h J H̄ and the units they are in: all of what [`factor`](Self::factor) was given.
    pub(crate) fn memory(&self) -> impl Iterator<Item = f64> {
        self.systems[0]
            .generator()
            .iter()
            .chain(&self.rows.units)
            .copied()
    }

    /// M as it was when its memory was taken.
    pub(crate) fn restore(&mut self, memory: &[f64]) -> Result<(), Singular> {
        let len = memory.len() - self.rows.n;
        let (generator, units) = memory.split_at(len);
        self.rows.units.copy_from_slice(units);
        for (systems, sign) in self.systems.iter_mut().zip([1.0, -1.0]) {
            let (_, g) = systems.generator_mut();
            g.iter_mut()
                .zip(generator)
                .for_each(|(g, &x)| *g = sign * x);
        }
        self.has_backward = false;
        self.systems[0].factor(&self.schur.blocks)
    }

    /// `solution` ← M⁻¹ `solution`.
    fn solve(&mut self, which: usize) {
        mix(&self.schur.left, &self.solution, &mut self.rhs);
        for j in (0..self.schur.blocks.len()).rev() {
            self.solve_block(j, which);
        }
        mix(&self.schur.right, &self.solution, &mut self.rhs);
        std::mem::swap(&mut self.solution, &mut self.rhs);
    }

    /// Solves for the rows of block j, those after it being known.
    fn solve_block(&mut self, j: usize, which: usize) {
        let (n, s) = (self.rows.n, self.rows.s);
        let block = self.schur.blocks[j];
        let (start, end) = (block.start, block.start + block.size);
        for row in start..end {
            let rhs = &mut self.rhs[row * n..][..n];
            for k in end..s {
                let c = self.schur.schur[(row, k)];
                let turned = &self.turned[k * n..][..n];
                rhs.iter_mut()
                    .zip(turned)
                    .for_each(|(sum, &x)| *sum += c * x);
            }
        }
        let eta = block.eta;
        let (first, second) = self.rhs[start * n..end * n].split_at(n);
        for (i, v) in self.pair.iter_mut().enumerate() {
            *v = first[i].into();
            if let Some(&x) = second.get(i) {
                *v += eta * x;
            }
        }
        self.systems[which].solve(j, &block, &mut self.pair);
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
            self.systems[which].apply(x, out);
        }
    }
}

impl<T: Float> Preconditioner<T> for Frozen {
    fn apply(&mut self, held: Held, rows: &mut [T]) {
        let which = held as usize;
        if held == Held::End
            && !std::mem::replace(&mut self.has_backward, true)
            && self.systems[1].factor(&self.schur.blocks).is_err()
        {
            // The iteration goes on with M = 1, and tells by its contraction.
            self.has_backward = false;
            return;
        }
        if let Some(size) = self.rows.gather(held, rows, &mut self.solution) {
            self.solve(which);
            self.rows.scatter(held, &self.solution, size, rows);
        }
    }
}

/// out = (C ⊗ I) x.
fn mix(c: &DMatrix<f64>, x: &[f64], out: &mut [f64]) {
    let s = c.nrows();
    let n = x.len() / s;
    for (i, out) in out.chunks_exact_mut(n).enumerate() {
        out.fill(0.0);
        for (k, x) in x.chunks_exact(n).enumerate() {
            let c = c[(i, k)];
            out.iter_mut().zip(x).for_each(|(sum, &x)| *sum += c * x);
        }
    }
}
