//! The iteration for any H: Z ← K L with L = h b J∇H, for all components.

use crate::convergence::again::Series;
use crate::forms::form::{Mix, Step};
use crate::forms::fused::{Small, rows_of, settle};
use crate::layout::row::{literal, times};
use crate::matrix::product::Mixes;
use equip_autodiff::{StageGradients, conjugate};
use equip_scalar::{Float, Kernel, Lanes};

pub(crate) struct Full<'a, T>(pub(crate) Step<'a, T>);

impl<T: Float> Kernel for Full<'_, T> {
    type Output = f64;

    #[inline(always)]
    fn run(&mut self) -> f64 {
        self.mix()
    }
}

/// h b J∇H of one component for a group of stages, from its gradient.
#[inline(always)]
fn increment<T: Float, const N: usize>(hb: &[T; N], gradient: &[T; N], negative: bool) -> [T; N] {
    let l = times(hb, gradient);
    if negative { l.map(|x| -x) } else { l }
}

impl<'a, T: Float> Full<'a, T> {
    #[inline(always)]
    pub(crate) fn in_doubles(self) -> Option<Full<'a, f64>> {
        self.0.in_doubles().map(Full)
    }
}

impl<'a, T: Float> Mix<'a, T> for Full<'a, T> {
    #[inline(always)]
    fn step(&mut self) -> &mut Step<'a, T> {
        &mut self.0
    }

    #[inline(always)]
    fn unknowns(&self) -> usize {
        self.0.hi.len()
    }

    #[inline(always)]
    fn increments<const N: usize>(&mut self, c: usize, groups: usize) {
        let step = self.0.views::<N>(groups);
        let (from, negative) = conjugate(c, step.hi.len());
        for g in 0..groups {
            let gradient = &step.gradients[from * groups + g];
            step.l[c * groups + g] = increment(&step.hb[g], gradient, negative);
        }
    }
}

impl<'a> Small<'a> for Full<'a, f64> {
    #[inline(always)]
    fn kernel<const C: usize, const N: usize>(
        &mut self,
        gradients: &impl StageGradients<C, N>,
        k: &impl Mixes<N>,
        _: &mut Series<'_>,
    ) -> f64 {
        let step = &mut self.0;
        let computed: [Lanes<N>; C] = gradients.at(rows_of::<C, N>(step.points));
        let hb = literal(step.hb.first_chunk());
        let l = rows_of::<C, N>(step.l);
        let kept = rows_of::<C, N>(step.gradients);

        for c in 0..C {
            let (from, negative) = conjugate(c, C);
            l[c] = increment(hb, &computed[from].0, negative);
            kept[c] = computed[c].0;
        }
        settle::<C, N>(k, step)
    }
}
