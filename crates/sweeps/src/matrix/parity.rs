//! Z = K L by pairs of stages: half the products.
//!
//! Nodes and weights are symmetric about the middle of the step, and U = K − ½ 1 1ᵀ joins Legendre
//! polynomials of different parity only: U_{s+1−i, s+1−j} = −U_ij, whatever the α's. So with S_j = L_j +
//! L_{s+1−j} and D_j = L_j − L_{s+1−j}, j up to the middle,
//!
//! $$ Z_i = \tfrac12 \sum_j S_j + (P S)_i + (Q D)_i, \qquad Z_{s+1-i} = \tfrac12 \sum_j S_j - (P S)_i + (Q D)_i, $$
//! $$ P_{ij} = \tfrac12 (U_{ij} + U_{i,s+1-j}), \qquad Q_{ij} = \tfrac12 (U_{ij} - U_{i,s+1-j}) . $$
//!
//! Q = −Pᵀ to the last bit, as U is antisymmetric: quadratic invariants are kept as they are by K itself.
//!
//! Done for s = 16, where the halves fill vectors of 8 doubles. Only inside the product does the second half
//! stand from its end backwards.
//!
//! Cost: s²/2 products for each component.

use crate::layout::row::{self, HALF, add, dot, literal, sum_of};
use crate::matrix::product::Mixes;
use equip_scalar::Float;
use std::array::from_fn;
use std::borrow::Borrow;

/// A row of L or Z: the first half of the stages, and the second.
type Row<T> = row::Row<T, 2, HALF>;

/// P and Q for an antisymmetric U with its symmetry, column by column, one behind the other.
pub(crate) fn fill<T: Float>(u: impl Fn(usize, usize) -> T, k: &mut [T]) {
    let (p, q) = k.split_at_mut(HALF * HALF);
    for j in 0..HALF {
        for i in 0..HALF {
            let (near, far) = (u(i, j), u(i, 2 * HALF - 1 - j));
            p[j * HALF + i] = (near + far) / T::int(2);
            q[j * HALF + i] = (near - far) / T::int(2);
        }
    }
}

/// The two numbers of P and Q that U_ij is the sum of.
pub(crate) fn parts<T: Float>(k: &[T], i: usize, j: usize) -> [T; 2] {
    let near = |x: usize| x.min(2 * HALF - 1 - x);
    let [p, q] = [0, HALF * HALF].map(|from| k[from + near(j) * HALF + near(i)]);
    [if i < HALF { p } else { -p }, if j < HALF { q } else { -q }]
}

/// S and D.
#[inline(always)]
fn folded<T: Float>(l: &Row<T>) -> Row<T> {
    let last = backwards(&l[1]);
    [
        from_fn(|i| l[0][i] + last[i]),
        from_fn(|i| l[0][i] - last[i]),
    ]
}

/// K L for one component from its S and D, `k` being P and Q.
#[inline(always)]
fn product<T: Float>(k: &Parts<T>, [s, d]: &Row<T>) -> Row<T> {
    let half = T::ratio(1, 2);
    let odd = dot(HALF, |j| &k[0][j], s);
    let even = dot(HALF, |j| &k[1][j], d);
    let mut whole = sum_of(from_fn(|j| [s[j]; HALF])).map(|x| x * half);
    add(&mut whole, &even);
    let first = from_fn(|i| whole[i] + odd[i]);
    [first, backwards(&from_fn(|i| whole[i] - odd[i]))]
}

#[inline(always)]
fn backwards<T: Float>(x: &[T; HALF]) -> [T; HALF] {
    from_fn(|i| x[HALF - 1 - i])
}

/// P and Q.
pub(crate) type Parts<T> = [[[T; HALF]; HALF]; 2];

/// K as P and Q, or where these stand.
pub(crate) struct Blocks<K>(K);

impl<T: Float> Blocks<Parts<T>> {
    #[inline(always)]
    pub(crate) fn of(k: &[T]) -> Self {
        Blocks(*Blocks::at(k).0)
    }
}

impl<'a, T: Float> Blocks<&'a Parts<T>> {
    #[inline(always)]
    pub(crate) fn at(k: &'a [T]) -> Self {
        Blocks(literal(k.as_chunks().0.as_chunks().0.first_chunk()))
    }
}

impl<T: Float, K: Borrow<Parts<T>>> Mixes<T, 2, HALF> for Blocks<K> {
    const FOLDS: bool = true;

    #[inline(always)]
    fn folded(&self, l: &Row<T>) -> Row<T> {
        folded(l)
    }

    #[inline(always)]
    fn product(&self, folded: &Row<T>) -> Row<T> {
        product(self.0.borrow(), folded)
    }
}
