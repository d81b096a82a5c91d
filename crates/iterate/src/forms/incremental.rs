//! The iteration of [`crate::forms::separable`] in one product, without the momenta: what a change of L_p
//! does to Z_q,
//!
//! $$ Z_q \leftarrow Z_q + h M^{-1} (K B K)\, \Delta L_p, \qquad B = \mathrm{diag}(b) . $$
//!
//! The same in exact numbers, if Z_q is K L of the L before. Rounded, K B K is not K twice, and quadratic
//! invariants are kept by K alone: drafts are for iterations with others to come, and L_q is made by these.
//! What a draft is off goes with ΔL_p, and is always to the same side: K B K is made with care
//! ([`crate::matrix::twofold`]).
//!
//! What an iteration of a small system waits for is one product after the other, and of a long chain they are
//! most of the work.
//!
//! For the α_k a step starts from, with which most iterations of it are made: K B K costs s³ products.

use crate::convergence::again::Again;
use crate::forms::form::{Mix, Moved, Step};
use crate::forms::fused::{Small, change, numbers, rows_of};
use crate::forms::separable::{Separable, force};
use crate::layout::row::{
    OnLines, Row, add, difference, in_memory, literal, placed, rows, rows_mut, scaled,
};
use crate::matrix::product::{Mixes, product_any};
use equip_autodiff::StageGradients;
use equip_scalar::{Float, Kernel, Pack};
use std::array::from_fn;
use std::ops::Range;

pub(crate) struct Incremental<'a, T> {
    /// With K B K in place of K.
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

/// ΔL_p, and L_p with it.
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
    fn block<const G: usize, const N: usize>(
        &mut self,
        k: &impl Mixes<T, G, N>,
        block: Range<usize>,
        change: &mut Moved<N>,
    ) {
        if !T::IS_DOUBLE {
            return self.wide_block(k, block, change);
        }
        let m = self.unknowns();
        let (h, step) = (self.h, &mut self.half.step);
        let hb: Row<T, G, N> = *literal(rows(step.hb).first());
        let gradients = &rows::<T, G, N>(step.gradients)[block.clone()];
        let l_p = &mut rows_mut::<T, G, N>(step.l)[block.start + m..block.end + m];
        let z = &mut rows_mut::<T, G, N>(step.z)[block.clone()];
        let q = &mut rows_mut::<T, G, N>(step.points)[block.clone()];
        let (hi, lo) = (&step.hi[block.clone()], &step.lo[block.clone()]);
        let inverse_scale = &step.inverse_scale[block.clone()];
        let w = &self.half.inverse_masses[block.clone()];
        let mut delta = OnLines([[T::int(0); N]; G]);
        for c in 0..block.len() {
            for g in 0..G {
                delta.0[g] = moved(&hb[g], &gradients[c][g], &mut l_p[c][g]);
            }
            let mixed = k.mixed(&mut delta.0);
            for g in 0..G {
                let by = scaled(&mixed[g], h * w[c]);
                change.see(&by, inverse_scale[c]);
                add(&mut z[c][g], &by);
                q[c][g] = placed(hi[c], lo[c], &z[c][g]);
            }
        }
    }

    #[inline(always)]
    fn one<const N: usize>(&mut self, c: usize, change: &mut Moved<N>) {
        let (m, h, w) = (self.unknowns(), self.h, self.half.inverse_masses[c]);
        let step = self.half.step.views::<N>();
        let groups = step.hb.len();
        let (q, p) = (c * groups, (c + m) * groups);
        for g in 0..groups {
            step.delta[g] = moved(&step.hb[g], &step.gradients[q + g], &mut step.l[p + g]);
        }
        for g in 0..groups {
            let mixed = product_any(step.k, &step.delta[..groups], g, step.s);
            let by = scaled(&mixed, h * w);
            change.see(&by, step.inverse_scale[c]);
            add(&mut step.z[q + g], &by);
            step.points[q + g] = placed(step.hi[c], step.lo[c], &step.z[q + g]);
        }
    }
}

impl<T: Float> Incremental<'_, T> {
    /// As [`Half::wide_block`].
    #[inline(always)]
    fn wide_block<const G: usize, const N: usize>(
        &mut self,
        k: &impl Mixes<T, G, N>,
        block: Range<usize>,
        change: &mut Moved<N>,
    ) {
        let (m, h) = (self.half.inverse_masses.len(), self.h);
        let step = &mut self.half.step;
        let hb = literal(rows::<T, G, N>(step.hb).first()).map(|hb| T::Pack::of(&hb));
        let l_p = &mut rows_mut::<T, G, N>(step.l)[m..];
        let z = rows_mut::<T, G, N>(step.z);
        let q = rows_mut::<T, G, N>(step.points);
        let splat = |x: T| T::Pack::<N>::splat(x);
        let mut delta = OnLines([[T::int(0); N]; G]);
        for c in block {
            let gradient = &rows::<T, G, N>(step.gradients)[c];
            for g in 0..G {
                let new = -(hb[g] * T::Pack::of(&gradient[g]));
                delta.0[g] = (new - T::Pack::of(&l_p[c][g])).numbers();
                l_p[c][g] = new.numbers();
            }
            let mixed = k.packs(in_memory(&mut delta.0));
            let by = splat(h * self.half.inverse_masses[c]);
            let (hi, lo) = (splat(step.hi[c]), splat(step.lo[c]));
            for g in 0..G {
                let by = mixed[g] * by;
                change.see_heads(by.heads(), step.inverse_scale[c]);
                let moved = T::Pack::of(&z[c][g]) + by;
                z[c][g] = moved.numbers();
                q[c][g] = (hi + (moved + lo)).numbers();
            }
        }
    }
}

/// As many as go on, with what one leaves to the next in registers.
impl<'a> Small<'a> for Incremental<'a, f64> {
    #[inline(always)]
    fn kernel<const C: usize, const N: usize>(
        &mut self,
        gradients: &impl StageGradients<C, N>,
        k: &impl Mixes<f64, 1, N>,
        again: &mut impl Again,
    ) -> f64 {
        let step = &mut self.half.step;
        let hb: &Row<f64, 1, N> = literal(rows(step.hb).first());
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
                delta[c] = [moved(&hb[0], &computed[c].0, &mut l[c][0])];
            }
            let mut by = [[[0.0; N]; 1]; C];
            for c in 0..C {
                let mixed = k.product(&delta[c]);
                by[c] = [scaled(&mixed[0], hw[c])];
                add(&mut z[c][0], &by[c][0]);
                q[c] = [placed(hi[c], lo[c], &z[c][0])];
            }
            let change = change(&by, numbers(step.inverse_scale));
            if !again.again(change) {
                (*to_l, *to_z, *to_q) = (l, z, q);
                return change;
            }
        }
    }
}
