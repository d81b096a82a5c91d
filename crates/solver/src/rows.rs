//! The sweep from the gradients on for a literal number of stages: a *row* is L or Z of one component, G groups of N lanes.
//!
//! The same operations in the same order as the general form in [`crate::mix`], bit for bit. With the length of a row known, K stays in registers.
//! The two products with K of a position and its momentum wait for each other, so they are done in two loops over a block: what is
//! under way at a time is products that do not. In a chain of 1024 masses with 8 stages a position and its momentum take 11 ns in place of 24 on
//! AVX-512, where the arithmetic alone is 44 vector instructions, two a cycle. Four components written side by side are taken apart by the
//! compiler, and are slower than the general form.

use crate::mix::{Half, Moved, Step, Whole, add, placed, product, scaled, times};
use equip_scalar::Float;
use std::ops::Range;

pub(crate) type Row<T, const G: usize, const N: usize> = [[T; N]; G];

/// Components whose rows stay in the first-level cache from one loop to the next.
const BLOCK: usize = 32;

/// K, in one of the forms it is kept in.
pub(crate) trait Mixes<T, const G: usize, const N: usize> {
    /// K L for one component.
    fn mixed(&self, l: &Row<T, G, N>) -> Row<T, G, N>;
}

/// K itself, in one group.
pub(crate) struct Square<T, const N: usize>([[T; N]; N]);

impl<T: Float, const N: usize> Square<T, N> {
    /// # Panics
    /// If K has fewer than N columns of N places.
    #[inline(always)]
    pub(crate) fn of(k: &[T]) -> Self {
        match k.as_chunks().0.first_chunk() {
            // A copy: what is written to the rows cannot change it.
            Some(columns) => Square(*columns),
            None => panic!("K has {N} columns"),
        }
    }
}

impl<T: Float, const N: usize> Mixes<T, 1, N> for Square<T, N> {
    #[inline(always)]
    fn mixed(&self, [l]: &Row<T, 1, N>) -> Row<T, 1, N> {
        [product(&self.0, l)]
    }
}

/// The first `s` columns of K, in several groups.
pub(crate) struct Columns<'a, T, const G: usize, const N: usize> {
    first: Row<T, G, N>,
    further: &'a [Row<T, G, N>],
}

impl<'a, T: Float, const G: usize, const N: usize> Columns<'a, T, G, N> {
    #[inline(always)]
    pub(crate) fn of(k: &'a [T], s: usize) -> Self {
        let columns = rows(k);
        Columns {
            first: columns[0],
            further: &columns[1..s],
        }
    }
}

impl<T: Float, const G: usize, const N: usize> Mixes<T, G, N> for Columns<'_, T, G, N> {
    #[inline(always)]
    fn mixed(&self, l: &Row<T, G, N>) -> Row<T, G, N> {
        let l = l.as_flattened();
        let mut sum = self.first;
        for part in &mut sum {
            *part = scaled(part, l[0]);
        }
        for (column, &l) in self.further.iter().zip(&l[1..]) {
            for g in 0..G {
                add(&mut sum[g], &scaled(&column[g], l));
            }
        }
        sum
    }
}

impl<T: Float> Half<'_, T> {
    #[inline(always)]
    pub(crate) fn by_rows<const G: usize, const N: usize>(&mut self, k: &impl Mixes<T, G, N>) -> T {
        let m = self.inverse_masses.len();
        let mut change = Moved::<T, N>::new();
        for first in (0..m).step_by(BLOCK) {
            self.block(k, first..m.min(first + BLOCK), &mut change);
        }
        change.reduce()
    }

    #[inline(always)]
    fn block<const G: usize, const N: usize>(
        &mut self,
        k: &impl Mixes<T, G, N>,
        block: Range<usize>,
        change: &mut Moved<T, N>,
    ) {
        let m = self.inverse_masses.len();
        let (len, momenta) = (block.len(), block.start + m..block.end + m);
        let step = &mut self.step;
        let hb = *row::<T, G, N>(step.hb);
        let gradients = &rows::<T, G, N>(step.gradients)[block.clone()];
        let (l_q, l_p) = rows_mut::<T, G, N>(step.l).split_at_mut(m);
        let (l_q, l_p) = (&mut l_q[block.clone()], &mut l_p[block.clone()]);
        let p = &mut rows_mut::<T, G, N>(step.points)[momenta.clone()];
        let (hi, lo) = (&step.hi[momenta.clone()], &step.lo[momenta]);
        let (w, b) = (
            &self.inverse_masses[block.clone()],
            &self.offset[block.clone()],
        );
        for c in 0..len {
            for g in 0..G {
                l_p[c][g] = times(&hb[g], &gradients[c][g]).map(|x| -x);
            }
            let moved = k.mixed(in_memory(&mut l_p[c]));
            for g in 0..G {
                let momenta = placed(hi[c], lo[c], &moved[g]);
                l_q[c][g] = times(&hb[g], &momenta.map(|p| w[c] * p + b[c]));
                p[c][g] = momenta;
            }
        }
        step.advance(k, block, change);
    }
}

impl<T: Float> Whole<'_, T> {
    #[inline(always)]
    pub(crate) fn by_rows<const G: usize, const N: usize>(&mut self, k: &impl Mixes<T, G, N>) -> T {
        let n = self.0.hi.len();
        let mut change = Moved::<T, N>::new();
        for first in (0..n).step_by(BLOCK) {
            self.block(k, first..n.min(first + BLOCK), &mut change);
        }
        change.reduce()
    }

    #[inline(always)]
    fn block<const G: usize, const N: usize>(
        &mut self,
        k: &impl Mixes<T, G, N>,
        block: Range<usize>,
        change: &mut Moved<T, N>,
    ) {
        let step = &mut self.0;
        let m = step.hi.len() / 2;
        let hb = *row::<T, G, N>(step.hb);
        let gradients = rows::<T, G, N>(step.gradients);
        let l = rows_mut::<T, G, N>(step.l);
        for c in block.clone() {
            let (from, negative) = if c < m { (c + m, false) } else { (c - m, true) };
            for g in 0..G {
                let row = times(&hb[g], &gradients[from][g]);
                l[c][g] = if negative { row.map(|x| -x) } else { row };
            }
        }
        step.advance(k, block, change);
    }
}

impl<T: Float> Step<'_, T> {
    /// Z ← K L and the stages, for the components of a block.
    #[inline(always)]
    fn advance<const G: usize, const N: usize>(
        &mut self,
        k: &impl Mixes<T, G, N>,
        block: Range<usize>,
        change: &mut Moved<T, N>,
    ) {
        let l = &rows::<T, G, N>(self.l)[block.clone()];
        let z = &mut rows_mut::<T, G, N>(self.z)[block.clone()];
        let points = &mut rows_mut::<T, G, N>(self.points)[block.clone()];
        let (hi, lo) = (&self.hi[block.clone()], &self.lo[block.clone()]);
        let inverse_scale = &self.inverse_scale[block.clone()];
        for c in 0..block.len() {
            let moved = k.mixed(&l[c]);
            for g in 0..G {
                change.see(&moved[g], &z[c][g], inverse_scale[c]);
                points[c][g] = placed(hi[c], lo[c], &moved[g]);
            }
            z[c] = moved;
        }
    }
}

/// What is to be read from memory number by number, where it has just been written: to take the numbers out of a vector the processor needs
/// the units that multiply and add.
#[inline(always)]
fn in_memory<R>(row: &mut R) -> &R {
    std::hint::black_box(row)
}

/// # Panics
/// If there is not a whole row.
#[inline(always)]
fn row<T, const G: usize, const N: usize>(x: &[T]) -> &Row<T, G, N> {
    match rows(x) {
        [row, ..] => row,
        [] => panic!("there is a weight for each of the stages"),
    }
}

#[inline(always)]
fn rows<T, const G: usize, const N: usize>(x: &[T]) -> &[Row<T, G, N>] {
    x.as_chunks().0.as_chunks().0
}

#[inline(always)]
fn rows_mut<T, const G: usize, const N: usize>(x: &mut [T]) -> &mut [Row<T, G, N>] {
    x.as_chunks_mut().0.as_chunks_mut().0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mix::stride_for;
    use equip_scalar::InstructionSet;

    /// Uneven numbers of all sizes in [−1, 1].
    fn numbers(len: usize, seed: usize) -> Vec<f64> {
        (0..len)
            .map(|i| ((i * i + 7 * i + seed) as f64 * 0.731).sin())
            .collect()
    }

    /// What a sweep of m positions and momenta writes, and the change it returns.
    fn made(
        s: usize,
        m: usize,
        run: impl FnOnce(Step<'_, f64>, &[f64], &[f64]) -> f64,
    ) -> Vec<f64> {
        let stride = stride_for::<f64>(s);
        let padded = |x: &[f64]| -> Vec<f64> {
            let rows = x.chunks_exact(s);
            rows.flat_map(|row| [row, &vec![0.0; stride - s]].concat())
                .collect()
        };
        let mut k = padded(&numbers(s * s, 1));
        k.resize(stride * stride, 0.0);
        let hb = padded(&numbers(s, 2));
        let [hi, lo, inverse_scale, w, b] = [3, 4, 5, 6, 7].map(|seed| numbers(2 * m, seed));
        let [mut gradients, mut l, mut folded, mut z, mut points] =
            [8, 9, 10, 11, 12].map(|seed| padded(&numbers(2 * m * s, seed)));
        let step = Step {
            k: &k,
            hb: &hb,
            hi: &hi,
            lo: &lo,
            inverse_scale: &inverse_scale,
            gradients: &mut gradients,
            l: &mut l,
            folded: &mut folded,
            z: &mut z,
            points: &mut points,
            s,
        };
        let change = run(step, &w[..m], &b[..m]);
        [l, z, points, vec![change]].concat()
    }

    fn half<'a>(step: Step<'a, f64>, w: &'a [f64], b: &'a [f64]) -> Half<'a, f64> {
        Half {
            step,
            inverse_masses: w,
            offset: b,
        }
    }

    #[test]
    fn rows_have_the_bits_of_the_general_form() {
        for (s, m) in [
            (2, 1),
            (4, 33),
            (6, 70),
            (8, 5),
            (8, 64),
            (9, 40),
            (12, 3),
            (15, 33),
        ] {
            let four = s <= 4;
            let expected = [
                made(s, m, |step, w, b| match half(step, w, b) {
                    mut task if four => task.lanes::<4>(),
                    mut task => task.lanes::<8>(),
                }),
                made(s, m, |step, _, _| match Whole(step) {
                    mut task if four => task.lanes::<4>(),
                    mut task => task.lanes::<8>(),
                }),
            ];
            for set in InstructionSet::available() {
                let found = [
                    made(s, m, |step, w, b| set.run(&mut half(step, w, b))),
                    made(s, m, |step, _, _| set.run(&mut Whole(step))),
                ];
                for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                    assert!(
                        found.to_bits() == expected.to_bits(),
                        "s = {s}, m = {m}, {set:?}"
                    );
                }
            }
        }
    }
}
