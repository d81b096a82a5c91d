//! The state y = (q, p) with the part that rounding would lose, and the compensated update.

use equip_scalar::Float;

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

    /// The same for increments stored component by component: x_i of component c at `c·stride + i`, i < `s`.
    pub(crate) fn advance_by_component(
        &self,
        increments: &[T],
        s: usize,
        stride: usize,
        next: &mut Self,
    ) {
        let zero = T::int(0);
        for (j, x) in increments.chunks_exact(stride).enumerate() {
            let (sum, lost) = x[..s].iter().fold((zero, self.lo[j]), |(sum, lost), &x| {
                let (sum, e) = T::two_sum(sum, x);
                (sum, lost + e)
            });
            let (y, e) = T::two_sum(self.hi[j], sum);
            let (hi, lo) = T::two_sum(y, e + lost);
            next.hi[j] = hi;
            next.lo[j] = lo;
        }
    }
}
