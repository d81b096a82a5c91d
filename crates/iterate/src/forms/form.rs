//! The linear half of an iteration, from the gradients to the next stages, compiled for every instruction
//! set.
//!
//! There are three forms: `full`, `separable`, `incremental`. For a block of components, a form computes the
//! increments first and then Z: products that depend on each other are computed in separate loops.
//!
//! Cost: s² products for each component to which K is applied.

use crate::layout::row::{by_groups, difference, largest, placed, stride_for};
use crate::matrix::product::product_any;
use equip_scalar::{Float, Pack};

/// The data common to all forms: the method, the start of the step, input and output. Component c of stage i
/// is at `c·stride + i`.
pub(crate) struct Step<'a, T> {
    /// K(α), or K B K for an incremental iteration, column by column.
    pub(crate) k: &'a [T],
    /// h b_i.
    pub(crate) hb: &'a [T],
    /// y0 of all components, as the sum hi + lo.
    pub(crate) hi: &'a [T],
    pub(crate) lo: &'a [T],
    /// The inverse sizes of the components.
    pub(crate) inverse_scale: &'a [T],
    pub(crate) gradients: &'a mut [T],
    pub(crate) l: &'a mut [T],
    /// Workspace for ΔL of an incremental iteration.
    pub(crate) delta: &'a mut [T],
    pub(crate) z: &'a mut [T],
    pub(crate) points: &'a mut [T],
    pub(crate) s: usize,
}

/// A form of the iteration.
pub(crate) trait Mix<'a, T: Float> {
    fn step(&mut self) -> &mut Step<'a, T>;
    /// The number of components whose Z is computed.
    fn unknowns(&self) -> usize;
    /// Computes L of component c from the gradients, in so many groups of lanes.
    fn increments<const N: usize>(&mut self, c: usize, groups: usize);
    /// Computes Z and the stages of component c from L.
    #[inline(always)]
    fn advance<const N: usize>(&mut self, c: usize, groups: usize, change: &mut Moved<N>) {
        self.step().views::<N>(groups).advance(c, change);
    }

    /// One iteration for all components. Returns the largest change of Z relative to the sizes of the
    /// components; the result is not finite if any change is not.
    #[inline(always)]
    fn mix(&mut self) -> f64 {
        let s = self.step().s;
        by_groups!(T, s, self)
    }

    #[inline(always)]
    fn groups<const N: usize>(&mut self, groups: usize) -> f64 {
        let (mut change, unknowns) = (Moved::new(), self.unknowns());
        for first in (0..unknowns).step_by(BLOCK) {
            let block = first..unknowns.min(first + BLOCK);
            for c in block.clone() {
                self.increments::<N>(c, groups);
            }
            for c in block {
                self.advance::<N>(c, groups, &mut change);
            }
        }
        change.reduce()
    }
}

/// The number of components whose rows stay in the first-level cache between the loops.
const BLOCK: usize = 32;

impl<'a, T: Float> Step<'a, T> {
    /// The same step if the type is `f64`.
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

    /// The step, viewed in groups of N lanes, so many for each component.
    #[inline(always)]
    pub(crate) fn views<const N: usize>(&mut self, groups: usize) -> Views<'_, T, N> {
        Views {
            k: self.k.as_chunks().0,
            hb: &self.hb.as_chunks().0[..groups],
            hi: self.hi,
            lo: self.lo,
            inverse_scale: self.inverse_scale,
            gradients: self.gradients.as_chunks().0,
            l: self.l.as_chunks_mut().0,
            delta: self.delta.as_chunks_mut().0,
            z: self.z.as_chunks_mut().0,
            points: self.points.as_chunks_mut().0,
            groups,
            s: self.s,
        }
    }
}

/// The step, viewed in groups of N lanes.
pub(crate) struct Views<'a, T, const N: usize> {
    k: &'a [[T; N]],
    pub(crate) hb: &'a [[T; N]],
    pub(crate) hi: &'a [T],
    pub(crate) lo: &'a [T],
    pub(crate) inverse_scale: &'a [T],
    pub(crate) gradients: &'a [[T; N]],
    pub(crate) l: &'a mut [[T; N]],
    pub(crate) delta: &'a mut [[T; N]],
    pub(crate) z: &'a mut [[T; N]],
    pub(crate) points: &'a mut [[T; N]],
    groups: usize,
    s: usize,
}

impl<T: Float, const N: usize> Views<'_, T, N> {
    /// K times this row, for the stages of group g.
    #[inline(always)]
    pub(crate) fn mixed(&self, row: &[[T; N]], g: usize) -> [T; N] {
        product_any(self.k, row, g, self.s)
    }

    /// Z ← K L and the stages, for one component.
    #[inline(always)]
    fn advance(&mut self, c: usize, change: &mut Moved<N>) {
        let first = c * self.groups;
        for g in 0..self.groups {
            let z = self.mixed(&self.l[first..][..self.groups], g);
            let at = first + g;
            change.see(&difference(&z, &self.z[at]), self.inverse_scale[c]);
            self.points[at] = placed(self.hi[c], self.lo[c], &z);
            self.z[at] = z;
        }
    }
}

/// The changes of Z, lane by lane. They are measured only, so `f64` suffices. Z is zero in the padding.
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
        let inverse_scale = inverse_scale.to_f64();
        for (i, by) in T::Pack::of(by).heads().into_iter().enumerate() {
            let moved = by.abs() * inverse_scale;
            let most = self.largest[i];
            self.largest[i] = if moved > most { moved } else { most };
            self.sum[i] += moved;
        }
    }

    #[inline(always)]
    fn reduce(&self) -> f64 {
        // The sums are not added up first: to do so the compiler would split the vectors of the loop.
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

    /// Irregular numbers in [−1, 1].
    fn numbers(len: usize, seed: usize) -> Vec<f64> {
        (0..len)
            .map(|i| ((i * i + 7 * i + seed) as f64 * 0.731).sin())
            .collect()
    }

    /// The output of an iteration of m positions and momenta, and the change that it returns.
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
    fn the_bits_do_not_depend_on_the_instruction_set() {
        for (s, m) in [
            (2, 1),
            (4, 33),
            (6, 70),
            (8, 5),
            (8, 64),
            (9, 40),
            (12, 3),
            (16, 33),
            (24, 5),
        ] {
            let expected = [
                made(s, m, |step, w, b| half(step, w, b).mix()),
                made(s, m, |step, _, _| Full(step).mix()),
                made(s, m, |step, w, b| draft(step, w, b).mix()),
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
