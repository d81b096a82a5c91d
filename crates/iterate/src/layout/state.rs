//! The state y = (q, p) with the remainder of its rounding, and the compensated update.

use crate::layout::row::{by_groups, stride_for};
use equip_scalar::{Float, InstructionSet, Kernel, Pack};

/// A state with about twice the working precision: y = `hi` + `lo`, with |`lo`| at most an ulp of `hi`.
#[derive(Debug, Clone, PartialEq)]
pub struct State<T> {
    /// The rounded state.
    pub hi: Vec<T>,
    /// The remainder of the rounding.
    pub lo: Vec<T>,
}

impl<T: Float> State<T> {
    /// The state (q, p).
    pub fn new(q: &[T], p: &[T]) -> Self {
        let hi: Vec<T> = q.iter().chain(p).copied().collect();
        let lo = vec![T::int(0); hi.len()];
        State { hi, lo }
    }

    /// Copies another state of the same length.
    pub fn copy_from(&mut self, other: &Self) {
        self.hi.copy_from_slice(&other.hi);
        self.lo.copy_from_slice(&other.lo);
    }

    /// A state of length zero, as a placeholder.
    pub fn empty() -> Self {
        State {
            hi: Vec::new(),
            lo: Vec::new(),
        }
    }

    /// y1 = y0 + Σ_i x_i, the final sum of the step, by compensated summation: the rounding error of `hi` is
    /// stored in `lo` and enters the next step (Kahan 1965). The increments are summed first, then one
    /// two-sum per component follows.
    ///
    /// `increments` holds the x_i component by component in the layout of an iteration, zero from `s` on. For
    /// types with vectors the two halves of a row are added, which shortens the chain of additions.
    ///
    /// Cost: 6s + 7 additions per component.
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
        by_groups!(T, self.s, self)
    }
}

impl<T: Float> Advance<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let rows = self.increments.as_chunks::<N>().0;
        let from = self.from.hi.iter().zip(&self.from.lo);
        let to = self.next.hi.iter_mut().zip(&mut self.next.lo);
        for (((&hi0, &lo0), (hi, lo)), row) in from.zip(to).zip(rows.chunks_exact(groups)) {
            let (sum, lost) = T::Pack::<N>::total(row);
            let (y, e) = T::two_sum(hi0, sum);
            (*hi, *lo) = T::two_sum(y, e + (lost + lo0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use equip_scalar::DoubleDouble;

    /// The compensated sum of numbers of different sizes agrees with double-double, up to its rounding.
    #[test]
    fn what_sums_lose_is_kept() {
        for s in [1, 3, 4, 6, 8, 11, 16, 24, 32] {
            let (n, stride) = (70, stride_for::<f64>(s));
            let number = |i: usize| ((i * i + 3 * i) as f64 * 0.377).sin();
            let from = State {
                hi: (0..n).map(|c| 1e3 * number(c)).collect(),
                lo: (0..n).map(|c| 1e-14 * number(c + 9)).collect(),
            };
            let mut increments = vec![0.0; n * stride];
            for (i, x) in increments.iter_mut().enumerate() {
                if i % stride < s {
                    *x = number(i) * 10_f64.powi(-((i % 7) as i32));
                }
            }
            let exact = |x: f64| DoubleDouble::exact(x);
            for set in InstructionSet::available() {
                let mut next = from.clone();
                from.advance_by_component(set, &increments, s, &mut next);
                for (c, increments) in increments.chunks_exact(stride).enumerate() {
                    let start = exact(from.hi[c]) + exact(from.lo[c]);
                    let sum = increments.iter().fold(start, |sum, &x| sum + exact(x));
                    let off = (exact(next.hi[c]) + exact(next.lo[c]) - sum).to_f64();
                    assert!(
                        off.abs() < 4e3 * f64::EPSILON.powi(2),
                        "component {c}, s = {s}, {set:?}: {off:e}"
                    );
                    assert_eq!(next.hi[c], sum.to_f64(), "component {c}, s = {s}, {set:?}");
                }
            }
        }
    }
}
