//! Stiff harmonic modes along single components of H = T(p) + U(q), where T has the masses 1/w. M = 1 + h² w
//! κ (A A), A = K(0) B, for the positions of these components, and M = 1 for the others.
//!
//! A component c is included if κ_c = ∂²U/∂q_c² has the sign of its mass and dominates its row of ∇²U. The
//! contraction of the iteration then depends on the rest of ∇²U only, for any hω.
//!
//! Cost: s³ operations for each mode to compute M⁻¹, s² to apply it to a right-hand side.

use equip_autodiff::Pattern;
use equip_iterate::{Held, Iterate, Preconditioner};
use equip_linear::DenseLu;
use equip_scalar::Float;
use equip_tableau::Coefficients;
use nalgebra::{DMatrix, DVector};

/// A stiff mode.
#[derive(Debug)]
struct StiffMode {
    c: usize,
    /// h² w κ.
    angle_squared: f64,
    inverse: DMatrix<f64>,
}

/// M of the stiff modes.
#[derive(Debug)]
pub(crate) struct Diagonal {
    s: usize,
    stride: usize,
    /// (K(0) B)².
    a_squared: DMatrix<f64>,
    springs: Vec<StiffMode>,
}

impl Diagonal {
    pub(crate) fn new<T: Float>(method: &Coefficients<T>, iterate: &Iterate<T>) -> Self {
        let s = iterate.stages();
        let k = method.matrix(&vec![T::int(0); method.alphas()]);
        let a = DMatrix::from_fn(s, s, |i, j| (k[i * s + j] * method.weights()[j]).to_f64());
        Diagonal {
            s,
            stride: iterate.stride(),
            a_squared: &a * &a,
            springs: Vec::new(),
        }
    }

    /// Finds the stiff modes of ∇²H, whose entries are in the order of the pattern, and computes M for a step
    /// of size `h`. Returns whether there are any.
    pub(crate) fn find<T: Float>(
        &mut self,
        (pattern, hessian): (&Pattern, &[T]),
        w: &[T],
        h: T,
    ) -> bool {
        let springs = (0..w.len()).filter_map(|c| Some((c, stiffness(pattern, hessian, w, c)?)));
        let made = springs.map(|(c, kappa)| (c, (h * w[c]).to_f64() * (h * kappa).to_f64()));
        self.make(made.collect())
    }

    /// The component and h² w κ of each mode, concatenated.
    pub(crate) fn memory(&self) -> impl Iterator<Item = f64> {
        self.springs
            .iter()
            .flat_map(|spring| [spring.c as f64, spring.angle_squared])
    }

    /// Restores M from its memory.
    pub(crate) fn restore(&mut self, memory: &[f64]) {
        let springs = memory.as_chunks::<2>().0.iter();
        self.make(springs.map(|&[c, angle]| (c as usize, angle)).collect());
    }

    fn make(&mut self, springs: Vec<(usize, f64)>) -> bool {
        let (s, a_squared) = (self.s, &self.a_squared);
        let make = |(c, angle_squared)| {
            let mut lu = DenseLu::new(s);
            lu.matrix_mut().copy_from(&(a_squared * angle_squared));
            (0..s).for_each(|i| lu.matrix_mut()[(i, i)] += 1.0);
            lu.factor().ok()?;
            let mut inverse = DMatrix::identity(s, s);
            for mut column in inverse.column_iter_mut() {
                let mut x: DVector<f64> = column.clone_owned();
                lu.solve(&mut x);
                column.copy_from(&x);
            }
            Some(StiffMode {
                c,
                angle_squared,
                inverse,
            })
        };
        self.springs = springs.into_iter().filter_map(make).collect();
        !self.springs.is_empty()
    }
}

/// κ_c, if it is restoring and dominates its row.
fn stiffness<T: Float>(pattern: &Pattern, hessian: &[T], w: &[T], c: usize) -> Option<T> {
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

impl<T: Float> Preconditioner<T> for Diagonal {
    fn apply(&mut self, held: Held, rows: &mut [T]) {
        let (s, stride) = (self.s, self.stride);
        // The reversed step has its stages in reverse order. M depends on h² only.
        let is_reversed = held == Held::End;
        let mut x = [T::int(0); equip_iterate::MAX_STAGES];
        let x = &mut x[..s];
        for spring in &self.springs {
            let q = &mut rows[spring.c * stride..][..s];
            if is_reversed {
                q.reverse();
            }
            x.fill(T::int(0));
            for (column, &q) in spring.inverse.column_iter().zip(&*q) {
                let terms = x.iter_mut().zip(column.iter());
                terms.for_each(|(x, &m)| *x += T::exact(m) * q);
            }
            q.copy_from_slice(x);
            if is_reversed {
                q.reverse();
            }
        }
    }
}
