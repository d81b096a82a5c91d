//! The state y = (q, p) with the part that rounding would lose, and the compensated update.

use crate::mix::{groups_of, lanes_of};
use equip_scalar::{Float, InstructionSet, Kernel};

/// A state carried to about twice the working precision: y = `hi` + `lo`, with |`lo`| at most an ulp of `hi`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct State<T> {
    pub(crate) hi: Vec<T>,
    pub(crate) lo: Vec<T>,
}

impl<T: Float> State<T> {
    pub(crate) fn new(q: &[T], p: &[T]) -> Self {
        let hi: Vec<T> = q.iter().chain(p).copied().collect();
        let lo = vec![T::int(0); hi.len()];
        State { hi, lo }
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.hi.copy_from_slice(&other.hi);
        self.lo.copy_from_slice(&other.lo);
    }

    /// A state of no length, to stand in for one that is lent out.
    pub(crate) fn empty() -> Self {
        State {
            hi: Vec::new(),
            lo: Vec::new(),
        }
    }

    /// y1 = y0 + Σ_i x_i, the last sum of the step, compensated: what the rounding of `hi` loses goes to `lo`
    /// and enters the next step (Kahan 1965; the sum of increments first, then one two-sum per component).
    ///
    /// `increments` holds the x_i one after the other. Cost: 6s + 7 additions per component.
    pub(crate) fn advance(&self, increments: &[T], next: &mut Self) {
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

    /// The same for increments stored component by component as for [`crate::mix`], the places from `s` on being zero: floats that have
    /// vectors add up half against half, so that the chain of additions is short.
    pub(crate) fn advance_by_component(
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
        match lanes_of::<T>(self.s) {
            4 => self.lanes::<4>(),
            8 => self.lanes::<8>(),
            _ => self.lanes::<1>(),
        }
    }
}

impl<T: Float> Advance<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let groups = groups_of::<T, N>(self.s);
        let increments = self.increments.as_chunks::<N>().0;
        let next = self.next.hi.iter_mut().zip(&mut self.next.lo);
        let start = self.from.hi.iter().zip(&self.from.lo);
        for (c, ((hi, lo), (&hi0, &lo0))) in next.zip(start).enumerate() {
            let row = &increments[c * groups..(c + 1) * groups];
            let (mut sum, mut lost) = (row[0], [T::int(0); N]);
            for x in &row[1..] {
                for i in 0..N {
                    let (s, e) = T::two_sum(sum[i], x[i]);
                    sum[i] = s;
                    lost[i] += e;
                }
            }
            let mut count = N;
            while count > 1 {
                count /= 2;
                for i in 0..count {
                    let (s, e) = T::two_sum(sum[i], sum[i + count]);
                    sum[i] = s;
                    lost[i] = (lost[i] + lost[i + count]) + e;
                }
            }
            let (y, e) = T::two_sum(hi0, sum[0]);
            (*hi, *lo) = T::two_sum(y, e + (lost[0] + lo0));
        }
    }
}
