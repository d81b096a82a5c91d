//! K(α) column by column, and K L for one component. Products are fused and sums have a fixed order
//! ([`crate::layout::row::dot`]), so the bits are the same on every instruction set.
//!
//! Cost: s² products.

use crate::layout::row::{add, dot, literal, stride_for};
use equip_scalar::{Float, Pack};
use equip_tableau::Coefficients;
use std::hint::black_box;

/// Writes K(α) of `method` to `k`, with padding of zeros. `room` is workspace for s² numbers.
pub(crate) fn columns_into<T: Float>(
    method: &Coefficients<T>,
    alphas: &[T],
    room: &mut [T],
    k: &mut [T],
) {
    let s = method.stages();
    let stride = stride_for::<T>(s);
    method.matrix_into(alphas, room);
    for (i, row) in room.chunks_exact(s).enumerate() {
        for (j, &x) in row.iter().enumerate() {
            k[j * stride + i] = x;
        }
    }
}

/// K for one group of stages of doubles.
pub(crate) trait Mixes<const N: usize> {
    /// K L.
    fn product(&self, l: &[f64; N]) -> [f64; N];
}

/// As many columns as lanes in one group of stages.
pub(crate) struct Square<'a, const N: usize>(&'a [[f64; N]; N]);

impl<'a, const N: usize> Square<'a, N> {
    #[inline(always)]
    pub(crate) fn of(k: &'a [f64]) -> Self {
        Square(literal(k.as_chunks().0.first_chunk()))
    }
}

impl<const N: usize> Mixes<N> for Square<'_, N> {
    #[inline(always)]
    fn product(&self, l: &[f64; N]) -> [f64; N] {
        dot(N, |j| &self.0[j], l)
    }
}

/// K loaded from memory for every product. If K does not fit into the registers, the compiler would otherwise
/// hoist it out of a loop and spill it to the stack.
pub(crate) struct Anew<M>(pub(crate) M);

impl<M: Mixes<N>, const N: usize> Mixes<N> for Anew<M> {
    #[inline(always)]
    fn product(&self, l: &[f64; N]) -> [f64; N] {
        black_box(&self.0).product(l)
    }
}

/// Σ_j K_ij L_j for the stages of group g. The sums over different groups of L are independent, which
/// shortens the chain of dependent operations.
#[inline(always)]
#[allow(clippy::needless_range_loop)] // The number of groups is constant after inlining.
pub(crate) fn product_any<T: Float, const N: usize>(
    k: &[[T; N]],
    l: &[[T; N]],
    g: usize,
    s: usize,
) -> [T; N] {
    let groups = l.len();
    if !T::IS_DOUBLE {
        let column = |j: usize| T::Pack::of(&k[j * groups + g]);
        return T::Pack::dot(column, &l.as_flattened()[..s]).numbers();
    }
    let mut sum = of_group(k, &l[0], (0, g), groups);
    for group in 1..groups {
        add(&mut sum, &of_group(k, &l[group], (group, g), groups));
    }
    sum
}

/// The contribution of the L of one group of stages to group g. The padding of K is zero.
#[inline(always)]
fn of_group<T: Float, const N: usize>(
    k: &[[T; N]],
    l: &[T; N],
    (group, g): (usize, usize),
    groups: usize,
) -> [T; N] {
    let columns = &k[group * N * groups..][..N * groups];
    dot(N, |j| &columns[j * groups + g], l)
}
