//! The iteration of a small system with up to eight stages as one kernel. It computes ∇H, L and Z ← K L with
//! fixed lengths, entirely in registers.
//!
//! The operations and their order are those of [`crate::forms::form`], so the results agree bit for bit. The
//! chain of dependent operations limits the speed of an iteration. The kernel therefore processes all
//! components in parallel along this chain: ∇U, then P ← p + K L_p, then Z_q ← K L_q.

use crate::convergence::again::Series;
use crate::forms::form::{Mix, Step};
use crate::layout::row::{OnLines, difference, in_memory, literal, placed};
use crate::matrix::product::{Anew, Mixes, Square};
use equip_autodiff::{Fused, StageGradients};

/// A form of the iteration for which there is a kernel.
pub(crate) trait Small<'a>: Mix<'a, f64> {
    /// Iterates C unknown components once; the incremental form continues as long as the series does.
    /// Returns the result of [`Mix::mix`] for the last iteration.
    fn kernel<const C: usize, const N: usize>(
        &mut self,
        gradients: &impl StageGradients<C, N>,
        k: &impl Mixes<N>,
        series: &mut Series<'_>,
    ) -> f64;
}

/// A form of the iteration, and the series that decides on further iterations.
pub(crate) struct OneGroup<'s, 'c, S>(pub(crate) S, pub(crate) &'s mut Series<'c>);

impl<'a, S: Small<'a>, const N: usize> Fused<N> for OneGroup<'_, '_, S> {
    type Output = f64;

    #[inline(always)]
    fn run<const C: usize>(&mut self, gradients: &impl StageGradients<C, N>) -> f64 {
        let k = Square::of(self.0.step().k);
        self.0.kernel(gradients, &k, self.1)
    }

    #[inline(always)]
    fn run_narrow<const C: usize>(&mut self, gradients: &impl StageGradients<C, N>) -> f64 {
        let k = Anew(Square::of(self.0.step().k));
        self.0.kernel(gradients, &k, self.1)
    }
}

/// The largest change of Z, `by`, relative to the sizes of the components, computed on integers: the bit
/// patterns of non-negative floats are ordered like the floats, and NaN is the largest. The maximum is taken
/// lane by lane, and over the lanes in memory; otherwise the compiler would extract all numbers from their
/// vectors.
#[inline(always)]
pub(crate) fn change<const C: usize, const N: usize>(
    by: &[[f64; N]; C],
    inverse_scale: &[f64; C],
) -> f64 {
    // Signed, because AVX2 compares signed integers.
    let mut most = OnLines([0_i64; N]);
    for (by, &inverse_scale) in by.iter().zip(inverse_scale) {
        for (most, &by) in most.0.iter_mut().zip(by) {
            *most = (*most).max((by * inverse_scale).abs().to_bits().cast_signed());
        }
    }
    let mut most = in_memory(&mut most).0;
    let mut count = N;
    while count > 1 {
        count /= 2;
        for i in 0..count {
            most[i] = most[i].max(most[i + count]);
        }
    }
    f64::from_bits(most[0].cast_unsigned())
}

/// Z ← K L and the stages. Returns the largest change of Z.
#[inline(always)]
pub(crate) fn settle<const C: usize, const N: usize>(
    k: &impl Mixes<N>,
    step: &mut Step<'_, f64>,
) -> f64 {
    let (hi, lo) = (numbers::<C>(step.hi), numbers::<C>(step.lo));
    let (l, z) = (rows_of::<C, N>(step.l), rows_of::<C, N>(step.z));
    let points = rows_of::<C, N>(step.points);
    let mut by = [[0.0; N]; C];
    for c in 0..C {
        let moved = k.product(&l[c]);
        points[c] = placed(hi[c], lo[c], &moved);
        by[c] = difference(&moved, &z[c]);
        z[c] = moved;
    }
    change(&by, numbers(step.inverse_scale))
}

/// The first C entries, one for each component.
#[inline(always)]
pub(crate) fn numbers<const C: usize>(x: &[f64]) -> &[f64; C] {
    literal(x.first_chunk())
}

/// The rows of the first C components.
#[inline(always)]
pub(crate) fn rows_of<const C: usize, const N: usize>(x: &mut [f64]) -> &mut [[f64; N]; C] {
    literal(x.as_chunks_mut().0.first_chunk_mut())
}
