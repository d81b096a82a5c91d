//! The iteration of any H: Z ← K L with L = h b J∇H, all components.

use crate::convergence::again::Again;
use crate::forms::form::{Mix, Moved, Step};
use crate::forms::fused::{Small, rows_of, settle};
use crate::layout::row::{Row, literal, rows, rows_mut, times};
use crate::matrix::product::Mixes;
use equip_autodiff::{StageGradients, conjugate};
use equip_scalar::{Float, Kernel, Lanes};
use std::array::from_fn;
use std::ops::Range;

pub(crate) struct Full<'a, T>(pub(crate) Step<'a, T>);

impl<T: Float> Kernel for Full<'_, T> {
    type Output = f64;

    #[inline(always)]
    fn run(&mut self) -> f64 {
        self.mix()
    }
}

/// h b J∇H of one component for a group of stages, from the gradient.
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
    fn block<const G: usize, const N: usize>(
        &mut self,
        k: &impl Mixes<T, G, N>,
        block: Range<usize>,
        change: &mut Moved<N>,
    ) {
        let step = &mut self.0;
        let hb: Row<T, G, N> = *literal(rows(step.hb).first());
        let gradients = rows::<T, G, N>(step.gradients);
        let l = rows_mut::<T, G, N>(step.l);
        for c in block.clone() {
            let (from, negative) = conjugate(c, step.hi.len());
            l[c] = from_fn(|g| increment(&hb[g], &gradients[from][g], negative));
        }
        step.advance(k, block, change);
    }

    #[inline(always)]
    fn one<const N: usize>(&mut self, c: usize, change: &mut Moved<N>) {
        let mut step = self.0.views::<N>();
        let groups = step.hb.len();
        let (from, negative) = conjugate(c, step.hi.len());
        for g in 0..groups {
            step.l[c * groups + g] =
                increment(&step.hb[g], &step.gradients[from * groups + g], negative);
        }
        step.advance(c, change);
    }
}

impl<'a> Small<'a> for Full<'a, f64> {
    #[inline(always)]
    fn kernel<const C: usize, const N: usize>(
        &mut self,
        gradients: &impl StageGradients<C, N>,
        k: &impl Mixes<f64, 1, N>,
        _again: &mut impl Again,
    ) -> f64 {
        let step = &mut self.0;
        let computed: [Lanes<N>; C] = gradients.at(rows_of::<C, N>(step.points));
        let hb: &Row<f64, 1, N> = literal(rows(step.hb).first());
        let l = rows_of::<C, N>(step.l);
        let kept = rows_of::<C, N>(step.gradients);

        for c in 0..C {
            let (from, negative) = conjugate(c, C);
            l[c] = [increment(&hb[0], &computed[from].0, negative)];
            kept[c] = [computed[c].0];
        }
        settle::<C, N>(k, step)
    }
}
