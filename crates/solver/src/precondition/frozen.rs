//! Simplified Newton, with one ∇²H for all stages: M = I − h (A ⊗ J H̄), A = K(0) B.
//!
//! With the real Schur form A = R S L ([`crate::precondition::schur`]) the system decouples into one complex
//! system for each eigenvalue of A, of size 2m, or m if H is separable
//! ([`crate::precondition::shifted_systems`]). The reversed step has the same systems with −h.
//!
//! All arithmetic is in `f64`: M affects the convergence, not the solution. docs/adr/0032 explains why it is
//! complex.
//!
//! Cost: ⌈s/2⌉ factorisations, and a solve with each for every right-hand side.

use crate::precondition::rows::Rows;
use crate::precondition::schur::Schur;
use crate::precondition::shifted_systems::ShiftedSystems;
use equip_autodiff::{Structure, turned};
use equip_iterate::{Held, Iterate, Preconditioner};
use equip_linear::Singular;
use equip_scalar::Float;
use equip_tableau::Coefficients;
use nalgebra::{Complex, DMatrix};

/// M with one ∇²H.
#[derive(Debug)]
pub(crate) struct Frozen {
    rows: Rows,
    schur: Schur,
    /// The systems with the start held, and with the end held. The latter are factorised on first use.
    systems: [ShiftedSystems; 2],
    has_backward: bool,
    /// Right-hand sides, solutions, and G times the solutions, row by row of the Schur form.
    rhs: Vec<f64>,
    solution: Vec<f64>,
    turned: Vec<f64>,
    pair: Vec<Complex<f64>>,
}

impl Frozen {
    /// `None` if the Schur form of the tableau does not exist.
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

    /// Factorises M for this ∇²H, with entries in the order of its pattern, a step of size `h`, and the sizes
    /// `scale` of the components. Returns the number of systems.
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

    /// The entries of h J H̄ and their units: everything that [`factor`](Self::factor) depends on.
    pub(crate) fn memory(&self) -> impl Iterator<Item = f64> {
        self.systems[0]
            .generator()
            .iter()
            .chain(&self.rows.units)
            .copied()
    }

    /// Restores M from its memory.
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

    /// Solves for the rows of block j. The rows of later blocks are known.
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
            // The iteration continues with M = 1; its contraction shows whether that suffices.
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
