//! ∇²H at the stages, and δL_i = h b_i J∇²H(Y_i) X_i.
//!
//! Cost: s Hessians.

use crate::iterate::iterate::Iterate;
use crate::layout::conjugate::turned;
use crate::layout::row::{by_groups, fused_each, scaled, stride_for};
use crate::linear::power_iteration::PowerIteration;
use equip_autodiff::{Evaluate, Pattern};
use equip_scalar::{Float, InstructionSet, Kernel};

/// h b_i ∇²H(Y_i).
#[derive(Debug)]
pub(crate) struct StageHessians<T: Float> {
    s: usize,
    stride: usize,
    set: InstructionSet,
    pub(crate) pattern: Pattern,
    /// Entry e at `e·stride + i`; the padding is zero.
    entries: Vec<T>,
    fastest: PowerIteration,
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
            pattern,
        }
    }

    /// Takes ∇²H at the stages of an iterate that has converged. Returns whether it is finite.
    pub(crate) fn take<E: Evaluate<T>>(&mut self, iterate: &Iterate<T>, energy: &mut E) -> bool {
        energy.hessians_by_component(&iterate.points, &mut self.entries, self.stride, self.s);
        let mut sum = T::int(0);
        for entry in self.entries.chunks_exact_mut(self.stride) {
            let (stages, padding) = entry.split_at_mut(self.s);
            for (x, &hb) in stages.iter_mut().zip(&iterate.hb) {
                *x = hb * *x;
                sum += *x;
            }
            padding.fill(T::int(0));
        }
        sum.is_finite()
    }

    /// Whether the fastest motion, ∇²H being the mean over the step, turns by an angle hω of at most `most`.
    pub(crate) fn is_within(&mut self, most: f64) -> bool {
        let places = self.entries.chunks_exact(self.stride);
        let mean = places.map(|entry| {
            let sum = entry[..self.s].iter().fold(T::int(0), |sum, &x| sum + x);
            sum.to_f64()
        });
        self.fastest.set(&self.pattern, mean);
        self.fastest.is_within(&self.pattern, most)
    }

    /// δL of these rows of ∇²H, of which the first `columns` count, from X of several sides.
    pub(crate) fn times(
        &self,
        rows: (usize, usize),
        columns: usize,
        (x, sides): (&[T], usize),
        dl: &mut [T],
    ) {
        self.set.run(&mut Times {
            pattern: &self.pattern,
            entries: &self.entries,
            rows,
            columns,
            x,
            dl,
            sides,
            stride: self.stride,
        });
    }
}

/// δL from X: rows of h b ∇²H times X, the sign being that of J.
struct Times<'a, T> {
    pub(crate) pattern: &'a Pattern,
    pub(crate) entries: &'a [T],
    /// First row and number of rows.
    rows: (usize, usize),
    /// Columns that are looked at.
    columns: usize,
    x: &'a [T],
    pub(crate) dl: &'a mut [T],
    sides: usize,
    pub(crate) stride: usize,
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
        for (place, row) in (self.rows.0..).take(self.rows.1).enumerate() {
            let mut side = 0;
            while side < self.sides {
                side += match self.sides - side {
                    1 => self.block::<N, 1>((place, row, side), groups),
                    2 => self.block::<N, 2>((place, row, side), groups),
                    _ => self.block::<N, 3>((place, row, side), groups),
                };
            }
        }
    }

    /// S sides of a row, whose sums stay in registers. Returns S.
    #[inline(always)]
    fn block<const N: usize, const S: usize>(
        &mut self,
        (place, row, side): (usize, usize, usize),
        groups: usize,
    ) -> usize {
        let (entries, x) = (self.entries.as_chunks::<N>().0, self.x.as_chunks::<N>().0);
        let dl = self.dl.as_chunks_mut::<N>().0;
        let (_, sign) = turned::<T>(row, self.pattern.dimension());
        let range = self.pattern.row_starts[row]..self.pattern.row_starts[row + 1];
        let columns = &self.pattern.columns[range.clone()];
        for g in 0..groups {
            let mut sums = [[T::int(0); N]; S];
            for (e, &column) in range.clone().zip(columns) {
                if column >= self.columns {
                    break;
                }
                let entry = &entries[e * groups + g];
                let x = &x[(column * self.sides + side) * groups..][..S * groups];
                for (k, sum) in sums.iter_mut().enumerate() {
                    *sum = fused_each(entry, &x[k * groups + g], sum);
                }
            }
            for (k, sum) in sums.iter().enumerate() {
                dl[(place * self.sides + side + k) * groups + g] = scaled(sum, sign);
            }
        }
        S
    }
}
