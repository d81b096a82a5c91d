//! ∇²H at the stages, and the products δL_i = h b_i J∇²H(Y_i) X_i.
//!
//! Cost: s Hessians.

use crate::iterate::iterate::Iterate;
use crate::layout::row::{by_groups, fused, fused_each, scaled, stride_for};
use crate::linear::power_iteration::PowerIteration;
use equip_autodiff::{Evaluator, Pattern, turned};
use equip_scalar::{Float, InstructionSet, Kernel};

/// h b_i ∇²H(Y_i).
#[derive(Debug)]
pub(crate) struct StageHessians<T: Float> {
    s: usize,
    stride: usize,
    set: InstructionSet,
    pub(crate) pattern: Pattern,
    /// Entry e of the pattern at `e·stride + i`; the padding is zero.
    pub(crate) entries: Vec<T>,
    fastest: PowerIteration,
    sizes: Vec<T>,
}

impl<T: Float> StageHessians<T> {
    pub(crate) fn new(iterate: &Iterate<T>, pattern: Pattern) -> Self {
        let stride = iterate.stride;
        let mut fastest = PowerIteration::default();
        fastest.make_room(&pattern);
        StageHessians {
            s: iterate.s,
            stride,
            set: iterate.set,
            entries: vec![T::int(0); pattern.len() * stride],
            fastest,
            sizes: vec![T::int(0); pattern.dimension()],
            pattern,
        }
    }

    /// Evaluates ∇²H at the converged stages of `iterate`.
    pub(crate) fn evaluate(&mut self, iterate: &Iterate<T>, energy: &mut Evaluator<T>) {
        energy.hessians_by_component(&iterate.points, &mut self.entries, self.stride, self.s);
    }

    /// Multiplies the entries by h b_i. Returns whether they are finite.
    pub(crate) fn weigh(&mut self, iterate: &Iterate<T>) -> bool {
        self.set.run(&mut Weigh {
            entries: &mut self.entries,
            hb: &iterate.hb,
            s: self.s,
        })
    }

    /// Whether the fastest motion satisfies hω ≤ `most`, with the mean of ∇²H over the step.
    pub(crate) fn is_within(&mut self, most: f64) -> bool {
        let mut bound = Bound {
            pattern: &self.pattern,
            entries: &self.entries,
            stride: self.stride,
            x: &mut self.sizes,
        };
        if self.set.run(&mut bound).to_f64() <= most * most {
            return true;
        }
        let places = self.entries.chunks_exact(self.stride);
        let mean = places.map(|entry| {
            let sum = entry[..self.s].iter().fold(T::int(0), |sum, &x| sum + x);
            sum.to_f64()
        });
        self.fastest.set(&self.pattern, mean);
        self.fastest.is_within(&self.pattern, most)
    }

    /// δL of these rows of ∇²H, from X, for all sides of X.
    pub(crate) fn times(&self, rows: (usize, usize), x: &[T], dl: &mut [T]) {
        self.set.run(&mut Times {
            pattern: &self.pattern,
            entries: &self.entries,
            rows,
            x,
            dl,
            stride: self.stride,
        });
    }
}

/// Σ_e entry_e X for one row and one group of stages, over the columns before `end`, for S sides from `side`
/// on.
#[inline(always)]
pub(crate) fn row_times<T: Float, const N: usize, const S: usize>(
    pattern: &Pattern,
    entries: &[T],
    (row, end): (usize, usize),
    x: &[T],
    (side, groups, g): (usize, usize, usize),
) -> [[T; N]; S] {
    let (entries, x) = (entries.as_chunks::<N>().0, x.as_chunks::<N>().0);
    let n = pattern.dimension();
    let range = pattern.row_starts[row]..pattern.row_starts[row + 1];
    let mut sums = [[T::int(0); N]; S];
    for (e, &column) in range.clone().zip(&pattern.columns[range]) {
        if column >= end {
            break;
        }
        let entry = &entries[e * groups + g];
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = fused_each(entry, &x[((side + k) * n + column) * groups + g], sum);
        }
    }
    sums
}

/// δL from X: rows of h b ∇²H times X, with the sign of J.
struct Times<'a, T> {
    pattern: &'a Pattern,
    entries: &'a [T],
    /// The first row, and the number of rows.
    rows: (usize, usize),
    x: &'a [T],
    dl: &'a mut [T],
    stride: usize,
}

impl<T: Float> Kernel for Times<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_groups!(T, self.stride, self);
    }
}

impl<T: Float> Times<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) {
        let sides = self.x.len() / (self.pattern.dimension() * self.stride);
        for row in (self.rows.0..).take(self.rows.1) {
            let mut side = 0;
            while side < sides {
                // With other types one side fills the registers.
                side += if const { T::IS_DOUBLE } {
                    match sides - side {
                        1 => self.block::<N, 1>((row, side), groups),
                        2 => self.block::<N, 2>((row, side), groups),
                        _ => self.block::<N, 3>((row, side), groups),
                    }
                } else {
                    self.block::<N, 1>((row, side), groups)
                };
            }
        }
    }

    /// One row of S sides. Returns S.
    #[inline(always)]
    fn block<const N: usize, const S: usize>(
        &mut self,
        (row, side): (usize, usize),
        groups: usize,
    ) -> usize {
        let n = self.pattern.dimension();
        let (to, sign) = turned::<T>(row, n);
        for g in 0..groups {
            let at = (side, groups, g);
            let sums = row_times::<T, N, S>(self.pattern, self.entries, (row, n), self.x, at);
            let dl = self.dl.as_chunks_mut::<N>().0;
            for (k, sum) in sums.iter().enumerate() {
                dl[((side + k) * n + to) * groups + g] = scaled(sum, sign);
            }
        }
        S
    }
}

/// (hω)² ≤ max_c (|A|² 1)_c, A = J Σ_i |h b_i ∇²H(Y_i)|. In most cases this bound suffices to show that hω is
/// small, at the cost of reading the entries once for each product.
struct Bound<'a, T> {
    pattern: &'a Pattern,
    entries: &'a [T],
    stride: usize,
    /// Workspace for x.
    x: &'a mut [T],
}

impl<T: Float> Kernel for Bound<'_, T> {
    type Output = T;

    #[inline(always)]
    fn run(&mut self) -> T {
        by_groups!(T, self.stride, self)
    }
}

impl<T: Float> Bound<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) -> T {
        let n = self.pattern.dimension();
        for c in 0..n {
            self.x[turned::<T>(c, n).0] = self.row::<N>(groups, c, |_| T::int(1));
        }
        let (x, mut most) = (&*self.x, T::int(0));
        for c in 0..n {
            most = most.max(self.row::<N>(groups, c, |column| x[column]));
        }
        most
    }

    /// Σ |entry| x over a row of ∇²H.
    #[inline(always)]
    fn row<const N: usize>(&self, groups: usize, c: usize, x: impl Fn(usize) -> T) -> T {
        let entries = self.entries.as_chunks::<N>().0;
        let mut sums = [T::int(0); N];
        for (e, column) in self.pattern.row(c) {
            let x = x(column);
            for entry in &entries[e * groups..][..groups] {
                let sizes = std::array::from_fn(|i| entry[i].abs());
                sums = fused(&sizes, x, &sums);
            }
        }
        sums.iter().fold(T::int(0), |sum, &x| sum + x)
    }
}

/// Multiplies the entries by h b_i, and clears the padding. Returns whether the entries are finite.
struct Weigh<'a, T> {
    entries: &'a mut [T],
    hb: &'a [T],
    s: usize,
}

impl<T: Float> Kernel for Weigh<'_, T> {
    type Output = bool;

    #[inline(always)]
    fn run(&mut self) -> bool {
        by_groups!(T, self.hb.len(), self)
    }
}

impl<T: Float> Weigh<'_, T> {
    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) -> bool {
        let hb = self.hb.as_chunks::<N>().0;
        let mut sums = [T::int(0); N];
        for row in self.entries.as_chunks_mut::<N>().0.chunks_exact_mut(groups) {
            for (g, (row, hb)) in row.iter_mut().zip(hb).enumerate() {
                for (i, (x, &hb)) in row.iter_mut().zip(hb).enumerate() {
                    let is_stage = g * N + i < self.s;
                    *x = if is_stage { hb * *x } else { T::int(0) };
                    sums[i] += *x;
                }
            }
        }
        sums.iter().fold(T::int(0), |a, &b| a + b).is_finite()
    }
}
