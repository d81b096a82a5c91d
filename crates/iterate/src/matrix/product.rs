//! K L for one component, K standing column by column. Products are fused and sums have one order
//! ([`crate::layout::row::dot`]), so the bits are the same on every instruction set.
//!
//! Cost: s² products.

use crate::MAX_STAGES;
use crate::layout::row::{HALF, Row, add, dot, fills_two, in_memory, literal, rows};
use equip_scalar::{Float, Pack};
use std::hint::black_box;

/// K in one of the forms it is kept in. What is read number by number is best read from memory.
pub(crate) trait Mixes<T: Float, const G: usize, const N: usize> {
    /// K L of what stands in memory.
    fn product(&self, l: &Row<T, G, N>) -> Row<T, G, N>;

    /// The same in packs, for what goes on with them.
    #[inline(always)]
    fn packs(&self, l: &Row<T, G, N>) -> [T::Pack<N>; G] {
        self.product(l).map(|row| T::Pack::of(&row))
    }

    /// K L of what has just been made.
    #[inline(always)]
    fn mixed(&self, l: &mut Row<T, G, N>) -> Row<T, G, N> {
        self.product(in_memory(l))
    }
}

/// K read where it stands for every product: where the registers are too few for it, the compiler would take
/// it out of a loop all the same and put it on the stack, 64 vectors of K B K for 16 stages.
pub(crate) struct Anew<M>(pub(crate) M);

impl<T: Float, M: Mixes<T, G, N>, const G: usize, const N: usize> Mixes<T, G, N> for Anew<M> {
    #[inline(always)]
    fn product(&self, l: &Row<T, G, N>) -> Row<T, G, N> {
        black_box(&self.0).product(l)
    }
}

/// As many columns as places in one group of stages.
pub(crate) struct Square<'a, T, const N: usize>(pub(crate) &'a [[T; N]; N]);

impl<'a, T: Float, const N: usize> Square<'a, T, N> {
    #[inline(always)]
    pub(crate) fn of(k: &'a [T]) -> Self {
        Square(literal(k.as_chunks().0.first_chunk()))
    }
}

impl<T: Float, const N: usize> Mixes<T, 1, N> for Square<'_, T, N> {
    #[inline(always)]
    fn product(&self, [l]: &Row<T, 1, N>) -> Row<T, 1, N> {
        [product(self.0, l)]
    }
}

/// As many columns as places in two groups: what the first and the last give is added at the end, so that
/// fewer operations wait for each other.
pub(crate) struct Sixteen<'a, T, const N: usize>(&'a [[Row<T, 2, N>; N]; 2]);

impl<'a, T: Float, const N: usize> Sixteen<'a, T, N> {
    #[inline(always)]
    pub(crate) fn of(k: &'a [T]) -> Self {
        Sixteen(literal(rows(k).as_chunks().0.first_chunk()))
    }
}

impl<T: Float, const N: usize> Mixes<T, 2, N> for Sixteen<'_, T, N> {
    #[inline(always)]
    fn product(&self, l: &Row<T, 2, N>) -> Row<T, 2, N> {
        let [first, last] = self.0;
        let mut sums = [group(first, 0, &l[0]), group(first, 1, &l[0])];
        add(&mut sums[0], &group(last, 0, &l[1]));
        add(&mut sums[1], &group(last, 1, &l[1]));
        sums
    }
}

/// What N columns give to group g.
#[inline(always)]
fn group<T: Float, const N: usize>(columns: &[Row<T, 2, N>; N], g: usize, l: &[T; N]) -> [T; N] {
    dot(N, |j| &columns[j][g], l)
}

/// The first columns, in several groups.
pub(crate) struct Columns<'a, T, const G: usize, const N: usize>(pub(crate) &'a [Row<T, G, N>]);

impl<T: Float, const G: usize, const N: usize> Mixes<T, G, N> for Columns<'_, T, G, N> {
    #[inline(always)]
    fn product(&self, l: &Row<T, G, N>) -> Row<T, G, N> {
        let mut sums = [[T::int(0); N]; G];
        for (g, sum) in sums.iter_mut().enumerate() {
            *sum = dot(self.0.len(), |j| &self.0[j][g], l.as_flattened());
        }
        sums
    }
}

/// The first columns, of numbers that take more than one word: put into packs once, and all groups together.
pub(crate) struct Packed<T: Float, const G: usize, const N: usize, const S: usize> {
    columns: [[T::Pack<N>; G]; S],
    s: usize,
}

impl<T: Float, const G: usize, const N: usize, const S: usize> Packed<T, G, N, S> {
    /// The first `s` of them, S at most.
    #[inline(always)]
    pub(crate) fn of(columns: &[Row<T, G, N>], s: usize) -> Self {
        let mut packed = [[T::Pack::splat(T::int(0)); G]; S];
        for (packed, column) in packed.iter_mut().zip(columns).take(s) {
            for g in 0..G {
                packed[g] = T::Pack::of(&column[g]);
            }
        }
        Packed { columns: packed, s }
    }
}

impl<T: Float, const G: usize, const N: usize, const S: usize> Mixes<T, G, N>
    for Packed<T, G, N, S>
{
    #[inline(always)]
    fn product(&self, l: &Row<T, G, N>) -> Row<T, G, N> {
        let mut sums = [[T::int(0); N]; G];
        for (sum, pack) in sums.iter_mut().zip(self.packs(l)) {
            *sum = pack.numbers();
        }
        sums
    }

    #[inline(always)]
    fn packs(&self, l: &Row<T, G, N>) -> [T::Pack<N>; G] {
        let mut sums = [T::Pack::splat(T::int(0)); G];
        for (g, sum) in sums.iter_mut().enumerate() {
            *sum = T::Pack::dot(&self.columns[..self.s], g, l.as_flattened());
        }
        sums
    }
}

/// A matrix, column by column, times a row.
#[inline(always)]
pub(crate) fn applied<T: Float, const G: usize, const N: usize>(
    matrix: &[T],
    x: &Row<T, G, N>,
    s: usize,
) -> Row<T, G, N> {
    if fills_two::<T>(s)
        && let Some(x) = rows::<T, 2, HALF>(x.as_flattened()).first()
    {
        let product = Sixteen::of(matrix).product(x);
        return *literal(rows(product.as_flattened()).first());
    }
    let mut product = [[T::int(0); N]; G];
    for (g, product) in product.iter_mut().enumerate() {
        *product = product_any(matrix.as_chunks().0, x, g, s);
    }
    product
}

/// Σ_j K_ij L_j for the stages of group g, L standing in as many groups.
#[inline(always)]
pub(crate) fn product_any<T: Float, const N: usize>(
    k: &[[T; N]],
    l: &[[T; N]],
    g: usize,
    s: usize,
) -> [T; N] {
    let groups = l.len();
    if !T::IS_DOUBLE {
        let mut packed = [[T::Pack::splat(T::int(0))]; MAX_STAGES];
        for (j, packed) in packed.iter_mut().enumerate().take(s) {
            *packed = [T::Pack::of(&k[j * groups + g])];
        }
        return T::Pack::dot(&packed[..s], 0, l.as_flattened()).numbers();
    }
    if let ([l], Some(columns)) = (l, k.first_chunk::<N>()) {
        // The padding of K is zero.
        return product(columns, l);
    }
    dot(s, |j| &k[j * groups + g], l.as_flattened())
}

/// Σ_j K_ij L_j for one group of stages, by literal lengths.
#[inline(always)]
fn product<T: Float, const N: usize>(columns: &[[T; N]; N], l: &[T; N]) -> [T; N] {
    dot(N, |j| &columns[j], l)
}
