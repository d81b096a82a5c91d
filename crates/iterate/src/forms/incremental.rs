//! The iteration of [`crate::forms::separable`] as one product without the momenta: the change of Z_q that
//! follows from a change of L_p is
//!
//! $$ Z_q \leftarrow Z_q + h M^{-1} (K B K)\, \Delta L_p, \qquad B = \mathrm{diag}(b) . $$
//!
//! In exact arithmetic both iterations are the same if Z_q = K L for the previous L. In floating point K B K
//! differs from two products with K, and only K conserves quadratic invariants. An incremental iteration is
//! therefore never the last one; the following iteration computes L_q. The error of an incremental iteration
//! is proportional to ΔL_p and always has the same sign, so K B K is computed accurately
//! ([`crate::matrix::twofold`]).
//!
//! In a small system, an iteration waits for its dependent products. In a long chain, the products are most
//! of the work. The incremental form has one product in place of two.
//!
//! K B K costs s³ products, so it exists for α = 0 only. Most iterations have α = 0.

use crate::convergence::again::Series;
use crate::forms::form::{Mix, Moved, Step};
use crate::forms::fused::{Small, change, numbers, rows_of};
use crate::forms::separable::{Separable, force};
use crate::layout::row::{add, difference, literal, placed, scaled};
use crate::matrix::product::Mixes;
use equip_autodiff::StageGradients;
use equip_scalar::{Float, Kernel};
use std::array::from_fn;

pub(crate) struct Incremental<'a, T> {
    /// The iteration with K B K in place of K.
    pub(crate) half: Separable<'a, T>,
    pub(crate) h: T,
}

impl<T: Float> Kernel for Incremental<'_, T> {
    type Output = f64;

    #[inline(always)]
    fn run(&mut self) -> f64 {
        self.mix()
    }
}

/// Updates L_p. Returns ΔL_p.
#[inline(always)]
fn moved<T: Float, const N: usize>(hb: &[T; N], gradient: &[T; N], l: &mut [T; N]) -> [T; N] {
    let new = force(hb, gradient);
    let moved = difference(&new, l);
    *l = new;
    moved
}

impl<'a, T: Float> Incremental<'a, T> {
    #[inline(always)]
    pub(crate) fn in_doubles(self) -> Option<Incremental<'a, f64>> {
        Some(Incremental {
            half: self.half.in_doubles()?,
            h: T::as_doubles(std::slice::from_ref(&self.h))?[0],
        })
    }
}

impl<'a, T: Float> Mix<'a, T> for Incremental<'a, T> {
    #[inline(always)]
    fn step(&mut self) -> &mut Step<'a, T> {
        &mut self.half.step
    }

    #[inline(always)]
    fn unknowns(&self) -> usize {
        self.half.unknowns()
    }

    #[inline(always)]
    fn increments<const N: usize>(&mut self, c: usize, groups: usize) {
        let m = self.unknowns();
        let step = self.half.step.views::<N>(groups);
        let (q, p) = (c * groups, (c + m) * groups);
        for g in 0..groups {
            step.delta[q + g] = moved(&step.hb[g], &step.gradients[q + g], &mut step.l[p + g]);
        }
    }

    #[inline(always)]
    fn advance<const N: usize>(&mut self, c: usize, groups: usize, change: &mut Moved<N>) {
        let hw = self.h * self.half.inverse_masses[c];
        let step = self.half.step.views::<N>(groups);
        let q = c * groups;
        for g in 0..groups {
            let mixed = step.mixed(&step.delta[q..][..groups], g);
            let by = scaled(&mixed, hw);
            change.see(&by, step.inverse_scale[c]);
            add(&mut step.z[q + g], &by);
            step.points[q + g] = placed(step.hi[c], step.lo[c], &step.z[q + g]);
        }
    }
}

/// Iterates until the series ends; the data passed between iterations stay in registers.
impl<'a> Small<'a> for Incremental<'a, f64> {
    #[inline(always)]
    fn kernel<const C: usize, const N: usize>(
        &mut self,
        gradients: &impl StageGradients<C, N>,
        k: &impl Mixes<N>,
        series: &mut Series<'_>,
    ) -> f64 {
        let step = &mut self.half.step;
        let hb = literal(step.hb.first_chunk());
        let (hi, lo) = (numbers::<C>(step.hi), numbers::<C>(step.lo));
        let w = numbers::<C>(self.half.inverse_masses);
        let hw: [f64; C] = from_fn(|c| self.h * w[c]);
        let to_l = rows_of::<C, N>(&mut step.l[C * N..]);
        let to_z = rows_of::<C, N>(step.z);
        let to_q = rows_of::<C, N>(step.points);
        let (mut l, mut z, mut q) = (*to_l, *to_z, *to_q);
        let delta = rows_of::<C, N>(step.delta);
        loop {
            let computed = gradients.at(&q);
            for c in 0..C {
                delta[c] = moved(hb, &computed[c].0, &mut l[c]);
            }
            let mut by = [[0.0; N]; C];
            for c in 0..C {
                by[c] = scaled(&k.product(&delta[c]), hw[c]);
                add(&mut z[c], &by[c]);
                q[c] = placed(hi[c], lo[c], &z[c]);
            }
            let change = change(&by, numbers(step.inverse_scale));
            if !series.again(change) {
                (*to_l, *to_z, *to_q) = (l, z, q);
                return change;
            }
        }
    }
}
