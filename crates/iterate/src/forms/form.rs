//! The linear half of an iteration, from the gradients to the next stages, compiled for every instruction
//! set.
//!
//! Three forms: `full`, `separable`, `incremental`. Each is
//! written for rows of any length, and by rows of literal length for up to 16 stages of doubles: the same
//! operations in the same order, bit for bit, and K stays in registers. In a chain of 1024 masses with 8
//! stages a position and its momentum take 11 ns by rows in place of 24 on AVX-512, where the arithmetic
//! alone is 44 vector instructions, two a cycle. Products that wait for each other are done in loops of their
//! own over a block of components. Four components written side by side are taken apart by the compiler, and
//! are slower than the general form.
//!
//! Cost: s² products for each component that K is applied to.

use crate::layout::row::{
    HALF, difference, fills_two, largest, literal, placed, rows, rows_mut, stride_for,
};
use crate::matrix::product::{Columns, Mixes, Packed, Sixteen, Square, product_any};
use equip_scalar::{Float, Pack};
use std::ops::Range;

/// What all forms need: the method, the start of the step, and where things go. Component c of stage i stands
/// at `c·stride + i`.
pub(crate) struct Step<'a, T> {
    /// K(α) column by column, or K B K of an incremental iteration.
    pub(crate) k: &'a [T],
    /// h b_i.
    pub(crate) hb: &'a [T],
    /// y0, all components.
    pub(crate) hi: &'a [T],
    pub(crate) lo: &'a [T],
    /// 1 over the sizes of the components.
    pub(crate) inverse_scale: &'a [T],
    pub(crate) gradients: &'a mut [T],
    pub(crate) l: &'a mut [T],
    /// Room for ΔL of an incremental iteration.
    pub(crate) delta: &'a mut [T],
    pub(crate) z: &'a mut [T],
    pub(crate) points: &'a mut [T],
    pub(crate) s: usize,
}

/// A form of the iteration, for any lengths.
pub(crate) trait Mix<'a, T: Float> {
    fn step(&mut self) -> &mut Step<'a, T>;
    /// Components whose Z is made.
    fn unknowns(&self) -> usize;
    /// By literal lengths, for the unknown components of a block.
    fn block<const G: usize, const N: usize>(
        &mut self,
        k: &impl Mixes<T, G, N>,
        block: Range<usize>,
        change: &mut Moved<N>,
    );
    /// For component c, of any number of groups.
    fn one<const N: usize>(&mut self, c: usize, change: &mut Moved<N>);

    /// All of it. Gives the largest change of Z relative to the sizes of the components; not finite if
    /// anything is not.
    #[inline(always)]
    fn mix(&mut self) -> f64 {
        let (k, s) = (self.step().k, self.step().s);
        if T::IS_DOUBLE {
            match stride_for::<T>(s) {
                _ if fills_two::<T>(s) => self.by_rows(&Sixteen::<T, HALF>::of(k)),
                4 => self.square::<4>(k),
                8 => self.square::<8>(k),
                16 => self.by_rows(&Columns::<T, 2, 8>(&rows(k)[..s])),
                24 => self.by_rows(&Columns::<T, 3, 8>(&rows(k)[..s])),
                _ => self.lanes::<8>(),
            }
        } else if const { T::WIDTH == 1 } {
            self.lanes::<1>()
        } else {
            match stride_for::<T>(s) {
                8 if s <= 4 => self.by_rows(&Packed::<T, 1, 8, 4>::of(rows(k), s)),
                8 => self.by_rows(&Packed::<T, 1, 8, 8>::of(rows(k), s)),
                16 => self.by_rows(&Packed::<T, 2, 8, 16>::of(rows(k), s)),
                24 => self.by_rows(&Packed::<T, 3, 8, 24>::of(rows(k), s)),
                _ => self.lanes::<8>(),
            }
        }
    }

    #[inline(always)]
    fn square<const N: usize>(&mut self, k: &'a [T]) -> f64 {
        // A copy: what is written to the rows cannot change it.
        let k = *literal(k.as_chunks().0.first_chunk());
        self.by_rows::<1, N>(&Square(&k))
    }

    #[inline(always)]
    fn by_rows<const G: usize, const N: usize>(&mut self, k: &impl Mixes<T, G, N>) -> f64 {
        let (mut change, unknowns) = (Moved::new(), self.unknowns());
        for first in (0..unknowns).step_by(BLOCK) {
            self.block(k, first..unknowns.min(first + BLOCK), &mut change);
        }
        change.reduce()
    }

    #[inline(always)]
    fn lanes<const N: usize>(&mut self) -> f64 {
        let mut change = Moved::<N>::new();
        for c in 0..self.unknowns() {
            self.one(c, &mut change);
        }
        change.reduce()
    }
}

/// Components whose rows stay in the first-level cache from one loop to the next.
const BLOCK: usize = 32;

impl<'a, T: Float> Step<'a, T> {
    /// The same, if the floats are doubles.
    #[inline(always)]
    pub(crate) fn in_doubles(self) -> Option<Step<'a, f64>> {
        Some(Step {
            k: T::as_doubles(self.k)?,
            hb: T::as_doubles(self.hb)?,
            hi: T::as_doubles(self.hi)?,
            lo: T::as_doubles(self.lo)?,
            inverse_scale: T::as_doubles(self.inverse_scale)?,
            gradients: T::as_doubles_mut(self.gradients)?,
            l: T::as_doubles_mut(self.l)?,
            delta: T::as_doubles_mut(self.delta)?,
            z: T::as_doubles_mut(self.z)?,
            points: T::as_doubles_mut(self.points)?,
            s: self.s,
        })
    }

    /// Z ← K L and the stages, for the components of a block.
    #[inline(always)]
    pub(crate) fn advance<const G: usize, const N: usize>(
        &mut self,
        k: &impl Mixes<T, G, N>,
        block: Range<usize>,
        change: &mut Moved<N>,
    ) {
        let l = &rows::<T, G, N>(self.l)[block.clone()];
        let z = &mut rows_mut::<T, G, N>(self.z)[block.clone()];
        let points = &mut rows_mut::<T, G, N>(self.points)[block.clone()];
        let (hi, lo) = (&self.hi[block.clone()], &self.lo[block.clone()]);
        let inverse_scale = &self.inverse_scale[block.clone()];
        for c in 0..block.len() {
            let moved = k.product(&l[c]);
            for g in 0..G {
                change.see(&difference(&moved[g], &z[c][g]), inverse_scale[c]);
                points[c][g] = placed(hi[c], lo[c], &moved[g]);
            }
            z[c] = moved;
        }
    }

    #[inline(always)]
    pub(crate) fn views<const N: usize>(&mut self) -> Views<'_, T, N> {
        Views {
            k: self.k.as_chunks().0,
            hb: self.hb.as_chunks().0,
            hi: self.hi,
            lo: self.lo,
            inverse_scale: self.inverse_scale,
            gradients: self.gradients.as_chunks().0,
            l: self.l.as_chunks_mut().0,
            delta: self.delta.as_chunks_mut().0,
            z: self.z.as_chunks_mut().0,
            points: self.points.as_chunks_mut().0,
            s: self.s,
        }
    }
}

/// The same in groups of N lanes.
pub(crate) struct Views<'a, T, const N: usize> {
    pub(crate) k: &'a [[T; N]],
    pub(crate) hb: &'a [[T; N]],
    pub(crate) hi: &'a [T],
    pub(crate) lo: &'a [T],
    pub(crate) inverse_scale: &'a [T],
    pub(crate) gradients: &'a [[T; N]],
    pub(crate) l: &'a mut [[T; N]],
    pub(crate) delta: &'a mut [[T; N]],
    pub(crate) z: &'a mut [[T; N]],
    pub(crate) points: &'a mut [[T; N]],
    pub(crate) s: usize,
}

impl<T: Float, const N: usize> Views<'_, T, N> {
    /// Σ_j K_ij L_j for the stages of group g, of the component whose L begins at `row`.
    #[inline(always)]
    pub(crate) fn mixed(&self, row: usize, g: usize) -> [T; N] {
        product_any(self.k, &self.l[row..row + self.hb.len()], g, self.s)
    }

    /// Z ← K L and the stages, for one component.
    #[inline(always)]
    pub(crate) fn advance(&mut self, c: usize, change: &mut Moved<N>) {
        let groups = self.hb.len();
        for g in 0..groups {
            let z = self.mixed(c * groups, g);
            self.moved(c, g, z, change);
        }
    }

    /// Z and the stages of component c, group g.
    #[inline(always)]
    pub(crate) fn moved(&mut self, c: usize, g: usize, z: [T; N], change: &mut Moved<N>) {
        let at = c * self.hb.len() + g;
        change.see(&difference(&z, &self.z[at]), self.inverse_scale[c]);
        self.points[at] = placed(self.hi[c], self.lo[c], &z);
        self.z[at] = z;
    }
}

/// Changes of Z, lane by lane: their size is asked for, so `f64` will do. Z of the padding is zero.
pub(crate) struct Moved<const N: usize> {
    largest: [f64; N],
    sum: [f64; N],
}

impl<const N: usize> Moved<N> {
    #[inline(always)]
    fn new() -> Self {
        Moved {
            largest: [0.0; N],
            sum: [0.0; N],
        }
    }

    #[inline(always)]
    pub(crate) fn see<T: Float>(&mut self, by: &[T; N], inverse_scale: T) {
        self.see_heads(T::Pack::of(by).heads(), inverse_scale);
    }

    #[inline(always)]
    pub(crate) fn see_heads<T: Float>(&mut self, by: [f64; N], inverse_scale: T) {
        let inverse_scale = inverse_scale.to_f64();
        for (i, by) in by.into_iter().enumerate() {
            let moved = by.abs() * inverse_scale;
            let most = self.largest[i];
            self.largest[i] = if moved > most { moved } else { most };
            self.sum[i] += moved;
        }
    }

    #[inline(always)]
    fn reduce(&self) -> f64 {
        // Not the sum of the sums: in quest of it the compiler would take the vectors of the loop apart.
        if self.sum.iter().all(|sum| sum.is_finite()) {
            largest(self.largest)
        } else {
            f64::NAN
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forms::full::Full;
    use crate::forms::incremental::Incremental;
    use crate::forms::separable::Separable;
    use equip_scalar::InstructionSet;

    /// Uneven numbers of all sizes in [−1, 1].
    fn numbers(len: usize, seed: usize) -> Vec<f64> {
        (0..len)
            .map(|i| ((i * i + 7 * i + seed) as f64 * 0.731).sin())
            .collect()
    }

    /// What an iteration of m positions and momenta writes, and the change it returns.
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
        let [mut gradients, mut l, mut delta, mut z, mut points] =
            [8, 9, 10, 11, 12].map(|seed| padded(&numbers(2 * m * s, seed)));
        let step = Step {
            k: &k,
            hb: &hb,
            hi: &hi,
            lo: &lo,
            inverse_scale: &inverse_scale,
            gradients: &mut gradients,
            l: &mut l,
            delta: &mut delta,
            z: &mut z,
            points: &mut points,
            s,
        };
        let change = run(step, &w[..m], &b[..m]);
        [l, z, points, vec![change]].concat()
    }

    fn half<'a>(step: Step<'a, f64>, w: &'a [f64], b: &'a [f64]) -> Separable<'a, f64> {
        Separable {
            step,
            inverse_masses: w,
            offset: b,
            keeps_momenta: true,
        }
    }

    fn draft<'a>(step: Step<'a, f64>, w: &'a [f64], b: &'a [f64]) -> Incremental<'a, f64> {
        Incremental {
            half: half(step, w, b),
            h: 0.75,
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
                made(s, m, |step, _, _| match Full(step) {
                    mut task if four => task.lanes::<4>(),
                    mut task => task.lanes::<8>(),
                }),
                made(s, m, |step, w, b| match draft(step, w, b) {
                    mut task if four => task.lanes::<4>(),
                    mut task => task.lanes::<8>(),
                }),
            ];
            for set in InstructionSet::available() {
                let found = [
                    made(s, m, |step, w, b| set.run(&mut half(step, w, b))),
                    made(s, m, |step, _, _| set.run(&mut Full(step))),
                    made(s, m, |step, w, b| set.run(&mut draft(step, w, b))),
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
