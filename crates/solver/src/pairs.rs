//! Z = K L by pairs of stages: half the products.
//!
//! Nodes and weights are symmetric about the middle of the step, and U = K − ½ 1 1ᵀ joins Legendre polynomials of different parity only:
//! U_{s+1−i, s+1−j} = −U_ij, whatever the α's. So with S_j = L_j + L_{s+1−j} and D_j = L_j − L_{s+1−j}, j up to the middle,
//!
//! $$ Z_i = \tfrac12 \sum_j S_j + (P S)_i + (Q D)_i, \qquad Z_{s+1-i} = \tfrac12 \sum_j S_j - (P S)_i + (Q D)_i, $$
//! $$ P_{ij} = \tfrac12 (U_{ij} + U_{i,s+1-j}), \qquad Q_{ij} = \tfrac12 (U_{ij} - U_{i,s+1-j}) . $$
//!
//! Q = −Pᵀ to the last bit, as U is antisymmetric: quadratic invariants are kept as they are by K itself.
//!
//! Done for s = 16, where the halves fill vectors of 8 doubles. Only inside the product does the second half stand from its end backwards.
//!
//! Cost: s²/2 products for each component.

use crate::mix::{Half, Moved, Step, Whole, add, placed, scaled, sum_of, times};
use equip_scalar::Float;
use std::array::from_fn;

/// Lanes of half the stages.
pub(crate) const HALF: usize = 8;

/// A row of L or Z: the first half of the stages, and the second.
type Row<T> = [[T; HALF]; 2];

/// Whether `s` stages of this float are mixed by pairs.
#[inline(always)]
pub(crate) fn has_pairs<T: Float>(s: usize) -> bool {
    T::as_doubles(&[]).is_some() && s == 2 * HALF
}

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

/// S and D.
#[inline(always)]
pub(crate) fn folded<T: Float>(l: &Row<T>) -> Row<T> {
    let last = backwards(&l[1]);
    [
        from_fn(|i| l[0][i] + last[i]),
        from_fn(|i| l[0][i] - last[i]),
    ]
}

/// K L for one component from its S and D, `k` being P and Q.
#[inline(always)]
pub(crate) fn product<T: Float>(k: &[[[T; HALF]; HALF]; 2], [s, d]: &Row<T>) -> Row<T> {
    let half = T::ratio(1, 2);
    let odd = sum_of(from_fn(|j| scaled(&k[0][j], s[j])));
    let even = sum_of(from_fn(|j| scaled(&k[1][j], d[j])));
    let mut whole = sum_of(from_fn(|j| [s[j]; HALF])).map(|x| x * half);
    add(&mut whole, &even);
    let first = from_fn(|i| whole[i] + odd[i]);
    [first, backwards(&from_fn(|i| whole[i] - odd[i]))]
}

#[inline(always)]
fn backwards<T: Float>(x: &[T; HALF]) -> [T; HALF] {
    from_fn(|i| x[HALF - 1 - i])
}

/// P and Q by literal lengths.
#[inline(always)]
pub(crate) fn blocks<T: Float>(k: &[T]) -> &[[[T; HALF]; HALF]; 2] {
    match k.as_chunks().0.as_chunks().0.first_chunk() {
        Some(blocks) => blocks,
        None => panic!("P and Q have {HALF} columns each"),
    }
}

impl<T: Float> Half<'_, T> {
    /// The sweep from the gradients on, component by component.
    #[inline(always)]
    pub(crate) fn by_pairs(&mut self) -> T {
        let m = self.inverse_masses.len();
        let k = blocks(self.step.k);
        let mut rows = Rows::of(&mut self.step);
        let mut change = Moved::<T, HALF>::new();
        for c in 0..m {
            let forces = rows.gradients[c];
            rows.l[c + m] = from_fn(|g| times(&rows.hb[g], &forces[g]).map(|x| -x));
            let z = product(k, &folded(&rows.l[c + m]));
            let p: Row<T> = from_fn(|g| placed(rows.hi[c + m], rows.lo[c + m], &z[g]));
            let (w, b) = (self.inverse_masses[c], self.offset[c]);
            rows.l[c] = from_fn(|g| times(&rows.hb[g], &p[g].map(|p| w * p + b)));
            rows.points[c + m] = p;
            rows.advance(c, k, &mut change);
        }
        change.reduce()
    }
}

impl<T: Float> Whole<'_, T> {
    /// The sweep from the gradients on, component by component.
    #[inline(always)]
    pub(crate) fn by_pairs(&mut self) -> T {
        let n = self.0.hi.len();
        let k = blocks(self.0.k);
        let mut rows = Rows::of(&mut self.0);
        let mut change = Moved::<T, HALF>::new();
        for c in 0..n {
            let gradient = rows.gradients[(c + n / 2) % n];
            let l: Row<T> = from_fn(|g| times(&rows.hb[g], &gradient[g]));
            rows.l[c] = if c < n / 2 {
                l
            } else {
                l.map(|x| x.map(|x| -x))
            };
            rows.advance(c, k, &mut change);
        }
        change.reduce()
    }
}

/// A step in rows.
struct Rows<'a, T> {
    hb: &'a Row<T>,
    hi: &'a [T],
    lo: &'a [T],
    inverse_scale: &'a [T],
    gradients: &'a [Row<T>],
    l: &'a mut [Row<T>],
    z: &'a mut [Row<T>],
    points: &'a mut [Row<T>],
}

impl<'a, T: Float> Rows<'a, T> {
    #[inline(always)]
    fn of(step: &'a mut Step<'_, T>) -> Self {
        let [hb, ..] = rows(step.hb) else {
            panic!("there is a weight for each of the stages");
        };
        Rows {
            hb,
            hi: step.hi,
            lo: step.lo,
            inverse_scale: step.inverse_scale,
            gradients: rows(step.gradients),
            l: step.l.as_chunks_mut().0.as_chunks_mut().0,
            z: step.z.as_chunks_mut().0.as_chunks_mut().0,
            points: step.points.as_chunks_mut().0.as_chunks_mut().0,
        }
    }

    /// Z ← K L and the stages, for one component.
    #[inline(always)]
    fn advance(&mut self, c: usize, k: &[[[T; HALF]; HALF]; 2], change: &mut Moved<T, HALF>) {
        let (hi, lo) = (self.hi[c], self.lo[c]);
        let before = std::mem::replace(&mut self.z[c], product(k, &folded(&self.l[c])));
        self.points[c] = from_fn(|g| placed(hi, lo, &self.z[c][g]));
        for (z, before) in self.z[c].iter().zip(&before) {
            change.see(z, before, self.inverse_scale[c]);
        }
    }
}

fn rows<T>(x: &[T]) -> &[Row<T>] {
    x.as_chunks().0.as_chunks().0
}
