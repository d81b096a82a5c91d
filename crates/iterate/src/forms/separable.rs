//! The iteration of H = T(p) + U(q), T = ½ Σ w_c p_c² + b·p, the positions unknown: L_p = −h b ∇U, P = p + K
//! L_p, L_q = h b (M⁻¹ P + b), Z_q ← K L_q.
//!
//! P is kept where it is asked for only: a long chain waits for its memory.

use crate::convergence::again::Again;
use crate::forms::form::{Mix, Moved, Step};
use crate::forms::fused::{Small, numbers, rows_of, settle};
use crate::layout::row::{Row, in_memory, linear, literal, placed, rows, rows_mut, times};
use crate::matrix::product::Mixes;
use equip_autodiff::StageGradients;
use equip_scalar::{Float, Kernel, Lanes, Pack};
use std::ops::Range;

pub(crate) struct Separable<'a, T> {
    pub(crate) step: Step<'a, T>,
    /// w and b.
    pub(crate) inverse_masses: &'a [T],
    pub(crate) offset: &'a [T],
    pub(crate) keeps_momenta: bool,
}

impl<T: Float> Kernel for Separable<'_, T> {
    type Output = f64;

    #[inline(always)]
    fn run(&mut self) -> f64 {
        self.mix()
    }
}

/// −h b ∇U for a group of stages.
#[inline(always)]
pub(crate) fn force<T: Float, const N: usize>(hb: &[T; N], gradient: &[T; N]) -> [T; N] {
    times(hb, gradient).map(|x| -x)
}

impl<'a, T: Float> Separable<'a, T> {
    #[inline(always)]
    pub(crate) fn in_doubles(self) -> Option<Separable<'a, f64>> {
        Some(Separable {
            step: self.step.in_doubles()?,
            inverse_masses: T::as_doubles(self.inverse_masses)?,
            offset: T::as_doubles(self.offset)?,
            keeps_momenta: self.keeps_momenta,
        })
    }
}

impl<'a, T: Float> Mix<'a, T> for Separable<'a, T> {
    #[inline(always)]
    fn step(&mut self) -> &mut Step<'a, T> {
        &mut self.step
    }

    #[inline(always)]
    fn unknowns(&self) -> usize {
        self.inverse_masses.len()
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
        let m = self.inverse_masses.len();
        let (len, momenta) = (block.len(), block.start + m..block.end + m);
        let step = &mut self.step;
        let hb: Row<T, G, N> = *literal(rows(step.hb).first());
        let gradients = &rows::<T, G, N>(step.gradients)[block.clone()];
        let (l_q, l_p) = rows_mut::<T, G, N>(step.l).split_at_mut(m);
        let (l_q, l_p) = (&mut l_q[block.clone()], &mut l_p[block.clone()]);
        let p = &mut rows_mut::<T, G, N>(step.points)[momenta.clone()];
        let (hi, lo) = (&step.hi[momenta.clone()], &step.lo[momenta]);
        let w = &self.inverse_masses[block.clone()];
        let b = &self.offset[block.clone()];
        for c in 0..len {
            for g in 0..G {
                l_p[c][g] = force(&hb[g], &gradients[c][g]);
            }
            let moved = k.mixed(&mut l_p[c]);
            for g in 0..G {
                let momenta = placed(hi[c], lo[c], &moved[g]);
                l_q[c][g] = times(&hb[g], &linear(w[c], &momenta, b[c]));
                if self.keeps_momenta {
                    p[c][g] = momenta;
                }
            }
        }
        step.advance(k, block, change);
    }

    #[inline(always)]
    fn one<const N: usize>(&mut self, c: usize, change: &mut Moved<N>) {
        let (w, b) = (self.inverse_masses[c], self.offset[c]);
        let mut step = self.step.views::<N>();
        let (m, groups) = (step.hi.len() / 2, step.hb.len());
        let (q, p) = (c * groups, (c + m) * groups);
        for g in 0..groups {
            step.l[p + g] = force(&step.hb[g], &step.gradients[q + g]);
        }
        for g in 0..groups {
            let momenta = placed(step.hi[c + m], step.lo[c + m], &step.mixed(p, g));
            step.l[q + g] = times(&step.hb[g], &linear(w, &momenta, b));
            if self.keeps_momenta {
                step.points[p + g] = momenta;
            }
        }
        step.advance(c, change);
    }
}

impl<T: Float> Separable<'_, T> {
    /// Numbers of more than one word stay in packs from one product to the next: to put the words in order
    /// and apart again takes as long as a product.
    #[inline(always)]
    fn wide_block<const G: usize, const N: usize>(
        &mut self,
        k: &impl Mixes<T, G, N>,
        block: Range<usize>,
        change: &mut Moved<N>,
    ) {
        let m = self.inverse_masses.len();
        let step = &mut self.step;
        let hb = literal(rows::<T, G, N>(step.hb).first()).map(|hb| T::Pack::of(&hb));
        let (l_q, l_p) = rows_mut::<T, G, N>(step.l).split_at_mut(m);
        let (q, p) = rows_mut::<T, G, N>(step.points).split_at_mut(m);
        let z = rows_mut::<T, G, N>(step.z);
        let splat = |x: &[T], c: usize| T::Pack::<N>::splat(x[c]);
        for c in block.clone() {
            let gradient = &rows::<T, G, N>(step.gradients)[c];
            for g in 0..G {
                l_p[c][g] = (-(hb[g] * T::Pack::of(&gradient[g]))).numbers();
            }
            let moved = k.packs(in_memory(&mut l_p[c]));
            let (hi, lo) = (splat(step.hi, c + m), splat(step.lo, c + m));
            let (w, b) = (splat(self.inverse_masses, c), splat(self.offset, c));
            for g in 0..G {
                let momenta = hi + (moved[g] + lo);
                l_q[c][g] = (hb[g] * (w * momenta + b)).numbers();
                if self.keeps_momenta {
                    p[c][g] = momenta.numbers();
                }
            }
        }
        for c in block {
            let moved = k.packs(in_memory(&mut l_q[c]));
            let (hi, lo) = (splat(step.hi, c), splat(step.lo, c));
            for g in 0..G {
                let by = moved[g] - T::Pack::of(&z[c][g]);
                change.see_heads(by.heads(), step.inverse_scale[c]);
                q[c][g] = (hi + (moved[g] + lo)).numbers();
                z[c][g] = moved[g].numbers();
            }
        }
    }
}

impl<'a> Small<'a> for Separable<'a, f64> {
    #[inline(always)]
    fn kernel<const C: usize, const N: usize>(
        &mut self,
        gradients: &impl StageGradients<C, N>,
        k: &impl Mixes<f64, 1, N>,
        _again: &mut impl Again,
    ) -> f64 {
        let step = &mut self.step;
        let computed: [Lanes<N>; C] = gradients.at(rows_of::<C, N>(step.points));
        let hb: &Row<f64, 1, N> = literal(rows(step.hb).first());
        let (hi_p, lo_p) = (numbers::<C>(&step.hi[C..]), numbers::<C>(&step.lo[C..]));
        let (w, b) = (numbers::<C>(self.inverse_masses), numbers::<C>(self.offset));
        let (l_q, l_p) = step.l.split_at_mut(C * N);
        let (l_q, l_p) = (rows_of::<C, N>(l_q), rows_of::<C, N>(l_p));
        let p = rows_of::<C, N>(&mut step.points[C * N..]);
        let kept = rows_of::<C, N>(step.gradients);

        for c in 0..C {
            l_p[c] = [force(&hb[0], &computed[c].0)];
            kept[c] = [computed[c].0];
        }
        for c in 0..C {
            let moved = k.product(&l_p[c]);
            let momenta: Row<f64, 1, N> = [placed(hi_p[c], lo_p[c], &moved[0])];
            l_q[c] = [times(&hb[0], &linear(w[c], &momenta[0], b[c]))];
            if self.keeps_momenta {
                p[c] = momenta;
            }
        }
        settle::<C, N>(k, step)
    }
}
