//! The sweep of a small system as one kernel: ∇H, L and Z ← K L with all lengths literal and everything in registers.
//!
//! The same operations in the same order as in [`crate::mix`], bit for bit. What bounds a sweep is the chain of dependent operations, which is
//! walked through for all components side by side: ∇U, then P ← p + K L_p, then Z_q ← K L_q.

use crate::mix::Mix;
use crate::pairs::HALF;
use crate::product::{Mixes, Square};
use crate::row::{Row, literal};
use equip_autodiff::{Fused, Slopes};
use equip_scalar::Lanes;

/// A form of the sweep that there is a kernel for.
pub(crate) trait Small<'a>: Mix<'a, f64> {
    /// Unknown components for each degree of freedom.
    const WIDTH: usize;

    /// The sweep of C unknown components from their slopes on. Gives what [`Mix::mix`] does.
    fn finish<const C: usize, const G: usize, const N: usize>(
        &mut self,
        slopes: &[[Lanes<N>; C]; G],
        k: &impl Mixes<f64, G, N>,
    ) -> f64;

    /// All of it.
    #[inline(always)]
    fn kernel<const C: usize, const G: usize, const N: usize>(
        &mut self,
        gradients: &impl Slopes<C, N>,
        k: &impl Mixes<f64, G, N>,
    ) -> f64 {
        let points = rows_of::<C, G, N>(self.step().points);
        let slopes = gradients.at(points);
        self.finish(&slopes, k)
    }
}

/// Up to eight stages: one group.
pub(crate) struct OneGroup<S>(pub(crate) S);

/// Sixteen stages: two groups.
pub(crate) struct TwoGroups<S>(pub(crate) S);

impl<'a, S: Small<'a>, const N: usize> Fused<N> for OneGroup<S> {
    type Output = f64;
    const GROUPS: usize = 1;

    #[inline(always)]
    fn run<const C: usize>(&mut self, gradients: &impl Slopes<C, N>) -> f64 {
        let k = Square(literal(self.0.step().k.as_chunks().0.first_chunk()));
        self.0.kernel(gradients, &k)
    }
}

impl<'a, S: Small<'a>> Fused<HALF> for TwoGroups<S> {
    type Output = f64;
    const GROUPS: usize = 2;

    #[inline(always)]
    fn run<const C: usize>(&mut self, gradients: &impl Slopes<C, HALF>) -> f64 {
        let k = S::sixteen(self.0.step().k);
        self.0.kernel(gradients, &k)
    }
}

/// The largest change of Z, `by`, relative to the sizes of the components, as an integer: of numbers that are not negative the larger has the
/// larger bits, and what is not a number the largest. A maximum of integers is the same in any order, so the compiler may take vectors.
#[inline(always)]
pub(crate) fn change<const C: usize, const G: usize, const N: usize>(
    by: &[Row<f64, G, N>; C],
    inverse_scale: &[f64; C],
) -> f64 {
    let mut most = 0;
    for (by, &inverse_scale) in by.iter().zip(inverse_scale) {
        for &by in by.as_flattened() {
            most = most.max((by * inverse_scale).abs().to_bits());
        }
    }
    f64::from_bits(most)
}

/// A number for each of C components.
#[inline(always)]
pub(crate) fn numbers<const C: usize>(x: &[f64]) -> &[f64; C] {
    literal(x.first_chunk())
}

/// The rows of C components.
#[inline(always)]
pub(crate) fn rows_of<const C: usize, const G: usize, const N: usize>(
    x: &mut [f64],
) -> &mut [Row<f64, G, N>; C] {
    literal(crate::row::rows_mut(x).first_chunk_mut())
}
