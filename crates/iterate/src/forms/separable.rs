//! The iteration for H = T(p) + U(q), T = ½ Σ w_c p_c² + b·p, with the positions as unknowns: L_p = −h b ∇U,
//! P = p + K L_p, L_q = h b (M⁻¹ P + b), Z_q ← K L_q.
//!
//! P is stored only if needed: long chains are limited by memory bandwidth.

use crate::convergence::again::Series;
use crate::forms::form::{Mix, Step};
use crate::forms::fused::{Small, numbers, rows_of, settle};
use crate::layout::row::{linear, literal, placed, times};
use crate::matrix::product::Mixes;
use equip_autodiff::StageGradients;
use equip_scalar::{Float, Kernel, Lanes};

pub(crate) struct Separable<'a, T> {
    pub(crate) step: Step<'a, T>,
    /// The inverse masses w and the offset b of T.
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
    fn increments<const N: usize>(&mut self, c: usize, groups: usize) {
        let (w, b) = (self.inverse_masses[c], self.offset[c]);
        let step = self.step.views::<N>(groups);
        let m = step.hi.len() / 2;
        let (q, p) = (c * groups, (c + m) * groups);
        for g in 0..groups {
            step.l[p + g] = force(&step.hb[g], &step.gradients[q + g]);
        }
        for g in 0..groups {
            let moved = step.mixed(&step.l[p..][..groups], g);
            let momenta = placed(step.hi[c + m], step.lo[c + m], &moved);
            step.l[q + g] = times(&step.hb[g], &linear(w, &momenta, b));
            if self.keeps_momenta {
                step.points[p + g] = momenta;
            }
        }
    }
}

impl<'a> Small<'a> for Separable<'a, f64> {
    #[inline(always)]
    fn kernel<const C: usize, const N: usize>(
        &mut self,
        gradients: &impl StageGradients<C, N>,
        k: &impl Mixes<N>,
        _: &mut Series<'_>,
    ) -> f64 {
        let step = &mut self.step;
        let computed: [Lanes<N>; C] = gradients.at(rows_of::<C, N>(step.points));
        let hb = literal(step.hb.first_chunk());
        let (hi_p, lo_p) = (numbers::<C>(&step.hi[C..]), numbers::<C>(&step.lo[C..]));
        let (w, b) = (numbers::<C>(self.inverse_masses), numbers::<C>(self.offset));
        let (l_q, l_p) = step.l.split_at_mut(C * N);
        let (l_q, l_p) = (rows_of::<C, N>(l_q), rows_of::<C, N>(l_p));
        let p = rows_of::<C, N>(&mut step.points[C * N..]);
        let kept = rows_of::<C, N>(step.gradients);

        for c in 0..C {
            l_p[c] = force(hb, &computed[c].0);
            kept[c] = computed[c].0;
        }
        for c in 0..C {
            let moved = k.product(&l_p[c]);
            let momenta = placed(hi_p[c], lo_p[c], &moved);
            l_q[c] = times(hb, &linear(w[c], &momenta, b[c]));
            if self.keeps_momenta {
                p[c] = momenta;
            }
        }
        settle::<C, N>(k, step)
    }
}
