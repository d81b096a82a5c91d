//! What the gradient of a component on a stiff spring κ will have changed by when a sweep is made.
//!
//! Z_q = F(L_p), F linear, and L_p are the forces that are there, or foreseen. With δ the forces at Z_q less those that Z_q was made with, a sweep as
//! it is would change Z_q by h w K B K δ. But as Z_q changes so does the force, by −h b κ ΔZ_q:
//!
//! $$ \Delta Z = h w\, M K B K\, \delta, \qquad M = (1 + h^2 w \kappa\, K B K B)^{-1} , $$
//!
//! and with κ ΔZ added to the gradient a sweep of any form, draft or not, does just this. At Z = 0, where there is nothing to compare with,
//! ΔZ = M (h c (w p + b) − h² w K B K B ∇U). With α ≠ 0 the M of α = 0 is as good as any: what is solved does not depend on it.
//!
//! The start: of the last step the gradient less κ(q − q1), q1 being where it ended, is prolonged, for it has no part in the fast motion. K + Kᵀ = 1 1ᵀ, so
//! the stages are Y = q1 − Kᵀ L_q.
//!
//! Cost: s² products for each spring in a sweep, 3 s² in the start of a step.

use crate::MAX_STAGES;
use crate::aligned::{Aligned, Places};
use crate::draft::twice;
use crate::linear::DenseLu;
use crate::pairs::{HALF, has_pairs};
use crate::product::{Mixes, Sixteen, product_any};
use crate::prolongation::View;
use crate::row::{by_lanes, groups_of, literal, rows, stride_for};
use crate::springs::Spring;
use equip_scalar::{Float, Kernel};
use equip_tableau::Gauss;
use nalgebra::DVector;

/// M for one stiffness.
#[derive(Debug)]
pub(crate) struct Matrix<T> {
    /// h² w κ.
    pub(crate) stiffness: T,
    /// h M K B K, column by column.
    by_force: Aligned<T>,
    /// h M c.
    by_velocity: Vec<T>,
    /// −Kᵀ, column by column.
    back: Aligned<T>,
}

impl<T: Float> Matrix<T> {
    pub(crate) fn new(gauss: &Gauss<T>, h: T, stiffness: T) -> Option<Self> {
        let s = gauss.stages();
        let stride = stride_for::<T>(s);
        let mut places = Places::default();
        let twice = twice(gauss, &mut places);
        let mut lu = DenseLu::new(s);
        let m = lu.matrix_mut();
        for (j, &b) in gauss.weights().iter().enumerate() {
            for i in 0..s {
                m[(i, j)] = T::int(i64::from(i == j)) + stiffness * (twice[j * stride + i] * b);
            }
        }
        lu.factor().ok()?;
        let solved = |column: &[T]| {
            let mut x = DVector::from_column_slice(&column[..s]);
            lu.solve(&mut x);
            x * h
        };
        let mut by_force = places.zeros(stride * stride);
        for (to, from) in (by_force.chunks_exact_mut(stride))
            .zip(twice.chunks_exact(stride))
            .take(s)
        {
            to[..s].copy_from_slice(solved(from).as_slice());
        }
        let mut by_velocity = vec![T::int(0); stride];
        by_velocity[..s].copy_from_slice(solved(gauss.nodes()).as_slice());
        let mut k = vec![T::int(0); s * stride];
        gauss.skew_columns_into(&vec![T::int(0); s - 1], stride, &mut k);
        let mut back = places.zeros(stride * stride);
        for j in 0..s {
            for i in 0..s {
                back[j * stride + i] = -k[i * stride + j];
            }
        }
        Some(Matrix {
            stiffness,
            by_force,
            by_velocity,
            back,
        })
    }
}

/// Where the gradients are from.
pub(crate) enum From<'a, T> {
    /// Z, which was made with this L.
    Made(&'a [T]),
    /// Z = 0, the start (hi, b).
    Nothing(&'a [T], &'a [T]),
    /// The last step.
    Last(&'a [T], &'a [T], Last<'a, T>),
}

/// The last step, and how it is prolonged.
#[derive(Clone, Copy)]
pub(crate) struct Last<'a, T> {
    pub(crate) prolongation: View<'a, T>,
    pub(crate) l: &'a [T],
    /// Its size over that of this step.
    pub(crate) ratio: T,
    /// ∇H at the start of this step, if it is known.
    pub(crate) known: Option<&'a [T]>,
}

/// Adds κ ΔZ to the gradients.
pub(crate) struct Foresee<'a, T: Float> {
    pub(crate) springs: &'a [Spring<T>],
    pub(crate) matrices: &'a [Matrix<T>],
    pub(crate) from: From<'a, T>,
    pub(crate) hb: &'a [T],
    pub(crate) gradients: &'a mut [T],
    /// Degrees of freedom.
    pub(crate) m: usize,
    pub(crate) s: usize,
}

impl<T: Float> Kernel for Foresee<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_lanes!(T, self.s, self)
    }
}

impl<T: Float> Foresee<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let (s, m, groups) = (self.s, self.m, groups_of::<T, N>(self.s));
        let hb = self.hb.as_chunks::<N>().0;
        let gradients = self.gradients.as_chunks_mut::<N>().0;
        let mut delta = [[T::int(0); N]; MAX_STAGES];
        let mut room = [[T::int(0); N]; MAX_STAGES];
        for &Spring {
            c,
            kappa,
            w,
            matrix,
        } in self.springs
        {
            let matrix = &self.matrices[matrix];
            let gradient = &mut gradients[c * groups..(c + 1) * groups];
            let delta = &mut delta[..groups];
            let room = &mut room[..groups];
            if let From::Last(_, _, last) = &self.from {
                let l = last.l.as_chunks::<N>().0;
                let (l_q, l_p) = (&l[c * groups..][..groups], &l[(c + m) * groups..][..groups]);
                apply(&matrix.back, l_q, room, s);
                for g in 0..groups {
                    for i in 0..N {
                        delta[g][i] = l_p[g][i] + last.ratio * hb[g][i] * kappa * room[g][i];
                    }
                }
                let at_start = last.known.map_or(T::int(0), |known| known[c]);
                let prepared = last.prolongation.prepared(delta, room, s);
                for (g, gradient) in gradient.iter_mut().enumerate() {
                    *gradient = last.prolongation.foretell(prepared, (g, s), T::int(1), at_start);
                }
            }
            for g in 0..groups {
                for i in 0..N {
                    delta[g][i] = -(hb[g][i] * gradient[g][i]);
                }
            }
            let mut velocity = T::int(0);
            match self.from {
                From::Made(l) => {
                    let l = &l.as_chunks::<N>().0[(c + m) * groups..][..groups];
                    for g in 0..groups {
                        for i in 0..N {
                            delta[g][i] -= l[g][i];
                        }
                    }
                }
                From::Nothing(hi, b) | From::Last(hi, b, _) => velocity = w * hi[c + m] + b[c],
            }
            apply(&matrix.by_force, delta, room, s);
            let by_velocity = matrix.by_velocity.as_chunks::<N>().0;
            let (kappa_w, kappa_v) = (kappa * w, kappa * velocity);
            for g in 0..groups {
                for i in 0..N {
                    gradient[g][i] += kappa_w * room[g][i] + kappa_v * by_velocity[g][i];
                }
            }
        }
    }
}

/// Matrix times x, column by column.
#[inline(always)]
fn apply<T: Float, const N: usize>(matrix: &[T], x: &[[T; N]], out: &mut [[T; N]], s: usize) {
    if has_pairs::<T>(s) {
        let x = x.as_flattened().as_chunks::<HALF>().0.as_chunks().0.first();
        let columns = Sixteen(literal(rows(matrix).as_chunks().0.first_chunk()));
        let product = columns.product(literal(x));
        let out = out.as_flattened_mut();
        for (out, product) in out.iter_mut().zip(product.as_flattened()) {
            *out = *product;
        }
        return;
    }
    for (g, out) in out.iter_mut().enumerate() {
        *out = product_any(matrix.as_chunks::<N>().0, x, g, s);
    }
}
