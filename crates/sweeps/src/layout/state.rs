//! The state y = (q, p) with the part that rounding would lose, and the compensated update.

use crate::layout::row::{OnLines, by_lanes, groups_of, in_memory, lanes_of, literal};
use equip_scalar::{Float, InstructionSet, Kernel, Pack};
use std::array::from_fn;

/// A state carried to about twice the working precision: y = `hi` + `lo`, with |`lo`| at most an ulp of `hi`.
#[derive(Debug, Clone, PartialEq)]
pub struct State<T> {
    /// The state, rounded.
    pub hi: Vec<T>,
    /// What rounding has left.
    pub lo: Vec<T>,
}

impl<T: Float> State<T> {
    /// (q, p).
    pub fn new(q: &[T], p: &[T]) -> Self {
        let hi: Vec<T> = q.iter().chain(p).copied().collect();
        let lo = vec![T::int(0); hi.len()];
        State { hi, lo }
    }

    /// Takes over another state of the same length.
    pub fn copy_from(&mut self, other: &Self) {
        self.hi.copy_from_slice(&other.hi);
        self.lo.copy_from_slice(&other.lo);
    }

    /// A state of no length, to stand in for one that is lent out.
    pub fn empty() -> Self {
        State {
            hi: Vec::new(),
            lo: Vec::new(),
        }
    }

    /// y1 = y0 + Σ_i x_i, the last sum of the step, compensated: what the rounding of `hi` loses goes to `lo`
    /// and enters the next step (Kahan 1965; the sum of increments first, then one two-sum per component).
    ///
    /// `increments` holds the x_i one after the other. Cost: 6s + 7 additions per component.
    pub fn advance(&self, increments: &[T], next: &mut Self) {
        let n = self.hi.len();
        for j in 0..n {
            let (mut sum, mut lost) = (T::int(0), self.lo[j]);
            for x in increments.chunks_exact(n) {
                let (s, e) = T::two_sum(sum, x[j]);
                sum = s;
                lost += e;
            }
            let (y, e) = T::two_sum(self.hi[j], sum);
            let (hi, lo) = T::two_sum(y, e + lost);
            next.hi[j] = hi;
            next.lo[j] = lo;
        }
    }

    /// The same for increments stored component by component as for `form`, the places from `s` on being
    /// zero: floats that have vectors add up half against half, so that the chain of additions is short.
    pub fn advance_by_component(
        &self,
        set: InstructionSet,
        increments: &[T],
        s: usize,
        next: &mut Self,
    ) {
        set.run(&mut Advance {
            from: self,
            increments,
            s,
            next,
        });
    }
}

struct Advance<'a, T> {
    from: &'a State<T>,
    increments: &'a [T],
    s: usize,
    next: &'a mut State<T>,
}

impl<T: Float> Kernel for Advance<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_lanes!(T, self.s, self)
    }
}

/// Components that are added up abreast: so many that the compiler takes vectors of them. Of one component
/// alone every addition waits for the one before.
const ABREAST: usize = 32;

/// Components of short states, a vector of them.
const FEW: usize = 4;

/// Sums of the components abreast and what they have lost, N numbers each.
type Sums<T, const N: usize> = [[[T; N]; ABREAST]; 2];

/// The first half of N numbers plus the second.
#[inline(always)]
fn fold<T: Float, const N: usize, const H: usize>(sum: &[T; N], lost: &[T; N]) -> [[T; H]; 2] {
    let (mut sums, mut losts) = ([T::int(0); H], [T::int(0); H]);
    for i in 0..H {
        let (s, e) = T::two_sum(sum[i], sum[i + H]);
        (sums[i], losts[i]) = (s, (lost[i] + lost[i + H]) + e);
    }
    [sums, losts]
}

/// Sums of the groups of a row, place by place, and what they have lost.
#[inline(always)]
fn row_sums<T: Float, const N: usize>(row: &[[T; N]]) -> [[T; N]; 2] {
    let (mut sum, mut lost) = (row[0], [T::int(0); N]);
    for x in &row[1..] {
        for i in 0..N {
            let (s, e) = T::two_sum(sum[i], x[i]);
            sum[i] = s;
            lost[i] += e;
        }
    }
    [sum, lost]
}

/// Of these the first half plus the second.
#[inline(always)]
fn half_sums<T: Float, const N: usize, const H: usize>(row: &[[T; N]]) -> [[T; H]; 2] {
    let [sum, lost] = row_sums(row);
    fold(&sum, &lost)
}

/// The same of all components.
#[inline(always)]
fn fold_all<T: Float, const N: usize, const H: usize>(from: &Sums<T, N>, to: &mut Sums<T, H>) {
    let ([sum, lost], [sums, losts]) = (from, to);
    for c in 0..ABREAST {
        [sums[c], losts[c]] = fold(&sum[c], &lost[c]);
    }
}

impl<T: Float> Advance<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let n = self.from.hi.len();
        let abreast = if T::IS_DOUBLE { n - n % ABREAST } else { 0 };
        if abreast > 0 {
            let zero = T::int(0);
            let mut quarters = [[[zero; 2]; ABREAST]; 2];
            let mut halves = [[[zero; 4]; ABREAST]; 2];
            let mut sums = [[[zero; 1]; ABREAST]; 2];
            for first in (0..abreast).step_by(ABREAST) {
                if N == 8 {
                    self.halves::<8, 4>(first, &mut halves);
                    fold_all(&halves, &mut quarters);
                } else {
                    self.halves::<4, 2>(first, &mut quarters);
                }
                fold_all(&quarters, &mut sums);
                self.several(first, &sums);
            }
        }
        let fours = if T::IS_DOUBLE { n - n % FEW } else { 0 };
        for first in (abreast..fours).step_by(FEW) {
            if N == 8 {
                self.few::<8, 4>(first);
            } else {
                self.few::<4, 2>(first);
            }
        }
        if T::IS_DOUBLE {
            (fours..n).for_each(|c| self.one::<N>(c));
        } else {
            self.by_totals::<N>();
        }
    }

    /// A few components from `first` on, a lane for each once the first halves are added to the second.
    #[inline(always)]
    fn few<const N: usize, const H: usize>(&mut self, first: usize) {
        let groups = groups_of::<T, N>(self.s);
        let rows = &self.increments.as_chunks::<N>().0[first * groups..(first + FEW) * groups];
        let mut halves = OnLines([[[T::int(0); H]; 2]; FEW]);
        for (half, row) in halves.0.iter_mut().zip(rows.chunks_exact(groups)) {
            *half = half_sums(row);
        }
        let halves = &in_memory(&mut halves).0;
        let mut sums = [[T::Pack::<FEW>::splat(T::int(0)); H]; 2];
        for k in 0..2 {
            for i in 0..H {
                sums[k][i] = T::Pack::of(&from_fn(|c| halves[c][k][i]));
            }
        }
        let [mut sum, mut lost] = sums;
        let mut count = H;
        while count > 1 {
            count /= 2;
            for i in 0..count {
                let (s, e) = T::Pack::two_sum(sum[i], sum[i + count]);
                (sum[i], lost[i]) = (s, (lost[i] + lost[i + count]) + e);
            }
        }
        let hi = T::Pack::of(literal(self.from.hi[first..].first_chunk()));
        let lo = T::Pack::of(literal(self.from.lo[first..].first_chunk()));
        let (y, e) = T::Pack::two_sum(hi, sum[0]);
        let (hi, lo) = T::Pack::two_sum(y, e + (lost[0] + lo));
        *literal(self.next.hi[first..].first_chunk_mut()) = hi.numbers();
        *literal(self.next.lo[first..].first_chunk_mut()) = lo.numbers();
    }

    /// Component c.
    #[inline(always)]
    fn one<const N: usize>(&mut self, c: usize) {
        let groups = groups_of::<T, N>(self.s);
        let row = &self.increments.as_chunks::<N>().0[c * groups..(c + 1) * groups];
        let [mut sum, mut lost] = row_sums(row);
        let mut count = N;
        while count > 1 {
            count /= 2;
            for i in 0..count {
                let (s, e) = T::two_sum(sum[i], sum[i + count]);
                sum[i] = s;
                lost[i] = (lost[i] + lost[i + count]) + e;
            }
        }
        let (y, e) = T::two_sum(self.from.hi[c], sum[0]);
        (self.next.hi[c], self.next.lo[c]) = T::two_sum(y, e + (lost[0] + self.from.lo[c]));
    }

    /// Floats of more than one word: a few components side by side once their rows are added up, as of `f64`.
    #[inline(always)]
    fn by_totals<const N: usize>(&mut self) {
        let groups = groups_of::<T, N>(self.s);
        let n = self.from.hi.len();
        let rows = self.increments.as_chunks::<N>().0;
        for first in (0..n).step_by(FEW) {
            let (mut sums, mut losts) = ([T::int(0); FEW], [T::int(0); FEW]);
            let totals = sums.iter_mut().zip(&mut losts);
            for ((sum, lost), row) in totals.zip(rows[first * groups..].chunks_exact(groups)) {
                (*sum, *lost) = T::Pack::total(row);
            }
            let hi = T::Pack::<FEW>::load(&self.from.hi[first..]);
            let lo = T::Pack::load(&self.from.lo[first..]);
            let (y, e) = T::Pack::two_sum(hi, T::Pack::of(&sums));
            let (hi, lo) = T::Pack::two_sum(y, e + (T::Pack::of(&losts) + lo));
            hi.store(&mut self.next.hi[first..]);
            lo.store(&mut self.next.lo[first..]);
        }
    }

    /// The same for the components from `first` on, up to half of the N sums of each.
    #[inline(always)]
    fn halves<const N: usize, const H: usize>(&self, first: usize, to: &mut Sums<T, H>) {
        let groups = groups_of::<T, N>(self.s);
        let rows = &self.increments.as_chunks::<N>().0[first * groups..(first + ABREAST) * groups];
        let [sums, losts] = to;
        for (c, row) in rows.chunks_exact(groups).enumerate() {
            [sums[c], losts[c]] = half_sums(row);
        }
    }

    /// … and with these sums the rest.
    #[inline(always)]
    fn several(&mut self, first: usize, [sum, lost]: &Sums<T, 1>) {
        let block = first..first + ABREAST;
        let from = self.from.hi[block.clone()].first_chunk::<ABREAST>();
        let from_lost = self.from.lo[block.clone()].first_chunk::<ABREAST>();
        let to = self.next.hi[block.clone()].first_chunk_mut::<ABREAST>();
        let to_lost = self.next.lo[block].first_chunk_mut::<ABREAST>();
        if let (Some(hi0), Some(lo0), Some(hi), Some(lo)) = (from, from_lost, to, to_lost) {
            for c in 0..ABREAST {
                let (y, e) = T::two_sum(hi0[c], sum[c][0]);
                (hi[c], lo[c]) = T::two_sum(y, e + (lost[c][0] + lo0[c]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::row::stride_for;

    #[test]
    fn components_abreast_have_the_bits_of_single_ones() {
        for s in [3, 4, 6, 8, 11, 16, 24] {
            let (n, stride) = (70, stride_for::<f64>(s));
            let number = |i: usize| ((i * i + 3 * i) as f64 * 0.377).sin();
            let from = State {
                hi: (0..n).map(|c| 1e3 * number(c)).collect(),
                lo: (0..n).map(|c| 1e-14 * number(c + 9)).collect(),
            };
            let mut increments = vec![0.0; n * stride];
            for (i, x) in increments.iter_mut().enumerate() {
                if i % stride < s {
                    *x = number(i);
                }
            }
            for set in InstructionSet::available() {
                let mut next = from.clone();
                from.advance_by_component(set, &increments, s, &mut next);
                for (c, increments) in increments.chunks_exact(stride).enumerate() {
                    let one = State {
                        hi: vec![from.hi[c]],
                        lo: vec![from.lo[c]],
                    };
                    let mut expected = one.clone();
                    one.advance_by_component(set, increments, s, &mut expected);
                    let bits = |hi: f64, lo: f64| (hi.to_bits(), lo.to_bits());
                    assert!(
                        bits(next.hi[c], next.lo[c]) == bits(expected.hi[0], expected.lo[0]),
                        "component {c}, s = {s}, {set:?}"
                    );
                }
            }
        }
    }
}
