//! Stiff springs along single components of H = T(p) + U(q), T with the masses 1/w: M = 1 + h² w κ (A A), A =
//! K(0) B, for the positions on springs, and 1 for all others.
//!
//! κ_c = ∂²U/∂q_c² where it has the sign of the mass, stands out of its row of ∇²U, and h² w κ is not small.
//! What the iteration contracts by is then the rest of ∇²U, whatever hω.
//!
//! With momenta as unknowns besides, M = (1, −h w A; h κ A, 1).
//!
//! Cost: s³ operations for each spring to make M⁻¹, s² for each right-hand side.

use equip_autodiff::Pattern;
use equip_linear::DenseLu;
use equip_scalar::Float;
use equip_sweeps::{Held, Iterate, Preconditioner};
use equip_tableau::Gauss;
use nalgebra::{DMatrix, DVector};

/// A component on a spring.
#[derive(Debug)]
struct Spring {
    c: usize,
    /// h κ and h w.
    push: f64,
    drift: f64,
    inverse: DMatrix<f64>,
}

/// M of springs.
#[derive(Debug)]
pub(crate) struct Diagonal {
    s: usize,
    stride: usize,
    m: usize,
    /// K(0) B.
    a: DMatrix<f64>,
    springs: Vec<Spring>,
}

impl Diagonal {
    pub(crate) fn new<T: Float>(gauss: &Gauss<T>, iterate: &Iterate<T>) -> Self {
        let s = iterate.stages();
        let mut k = vec![T::int(0); s * s];
        gauss.skew_into(&vec![T::int(0); s - 1], &mut k);
        Diagonal {
            s,
            stride: iterate.stride(),
            m: iterate.components() / 2,
            a: DMatrix::from_fn(s, s, |i, j| (k[i * s + j] * gauss.weights()[j]).to_f64()),
            springs: Vec::new(),
        }
    }

    /// Finds the springs of this ∇²H, whose entries are in the order of the pattern, and makes M for a step
    /// of size `h`. Returns whether there are any.
    pub(crate) fn find<T: Float>(
        &mut self,
        (pattern, hessian): (&Pattern, &[T]),
        w: &[T],
        h: T,
    ) -> bool {
        let springs =
            (0..w.len()).filter_map(|c| Some((c, spring_constant(pattern, hessian, w, c)?)));
        let made = springs.map(|(c, kappa)| (c, (h * w[c]).to_f64(), (h * kappa).to_f64()));
        self.make(made.collect())
    }

    /// Component, h w and h κ of each spring, one after the other.
    pub(crate) fn memory(&self) -> impl Iterator<Item = f64> {
        self.springs
            .iter()
            .flat_map(|spring| [spring.c as f64, spring.drift, spring.push])
    }

    /// M as it was when its memory was taken.
    pub(crate) fn restore(&mut self, memory: &[f64]) {
        let springs = memory.as_chunks::<3>().0.iter();
        self.make(
            springs
                .map(|&[c, drift, push]| (c as usize, drift, push))
                .collect(),
        );
    }

    fn make(&mut self, springs: Vec<(usize, f64, f64)>) -> bool {
        let (s, a) = (self.s, &self.a);
        let squared = a * a;
        self.springs = springs
            .into_iter()
            .filter_map(|(c, drift, push)| {
                let mut lu = DenseLu::new(s);
                lu.matrix_mut().copy_from(&(&squared * (drift * push)));
                (0..s).for_each(|i| lu.matrix_mut()[(i, i)] += 1.0);
                lu.factor().ok()?;
                let mut inverse = DMatrix::identity(s, s);
                for mut column in inverse.column_iter_mut() {
                    let mut x: DVector<f64> = column.clone_owned();
                    lu.solve(&mut x);
                    column.copy_from(&x);
                }
                Some(Spring {
                    c,
                    push,
                    drift,
                    inverse,
                })
            })
            .collect();
        !self.springs.is_empty()
    }
}

/// κ_c, if it pulls back and stands out of its row.
fn spring_constant<T: Float>(pattern: &Pattern, hessian: &[T], w: &[T], c: usize) -> Option<T> {
    let (mut kappa, mut rest) = (T::int(0), T::int(0));
    for (place, j) in pattern.row(c) {
        if j == c {
            kappa = hessian[place];
        } else if j < w.len() {
            rest += hessian[place].abs() * (w[j] / w[c]).abs().sqrt();
        }
    }
    (kappa * w[c] > T::int(0) && kappa.abs() >= rest).then_some(kappa)
}

/// y += factor · matrix · x.
fn add_product<T: Float>(y: &mut [T], (matrix, factor): (&DMatrix<f64>, f64), x: &[T]) {
    let columns = matrix.as_slice().chunks_exact(matrix.nrows());
    for (column, &x) in columns.zip(x) {
        for (y, &m) in y.iter_mut().zip(column) {
            *y += T::exact(factor * m) * x;
        }
    }
}

impl<T: Float> Preconditioner<T> for Diagonal {
    fn apply(&mut self, held: Held, rows: &mut [T], sides: usize) {
        let (s, stride) = (self.s, self.stride);
        let has_momenta = rows.len() / (sides * stride) > self.m;
        // The step made backwards has its stages in reverse and −h in place of h.
        let is_reversed = held == Held::End;
        let sign = if is_reversed { -1.0 } else { 1.0 };
        let (positions, momenta) = rows.split_at_mut(self.m * sides * stride);
        let mut x = [T::int(0); equip_sweeps::MAX_STAGES];
        let x = &mut x[..s];
        for spring in &self.springs {
            for side in 0..sides {
                let at = (spring.c * sides + side) * stride;
                let q = &mut positions[at..][..s];
                let mut p = has_momenta.then(|| &mut momenta[at..][..s]);
                if is_reversed {
                    q.reverse();
                    p.iter_mut().for_each(|p| p.reverse());
                }
                if let Some(p) = &p {
                    add_product(q, (&self.a, sign * spring.drift), p);
                }
                x.fill(T::int(0));
                add_product(x, (&spring.inverse, 1.0), q);
                q.copy_from_slice(x);
                if let Some(p) = &mut p {
                    add_product(p, (&self.a, -sign * spring.push), q);
                }
                if is_reversed {
                    q.reverse();
                    p.iter_mut().for_each(|p| p.reverse());
                }
            }
        }
    }
}
