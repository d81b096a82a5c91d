//! Where a swept step begins: the guess Z = E L_old, the stages, and the sizes of the components.
//!
//! The size of a component is max(|y_c|, max_i |Y_ic|), no less than ε^(3/4) of the largest position or momentum: the
//! front of a wave that runs into a chain at rest is not resolved to its own last bit.
//!
//! Cost: s² products for each unknown component.

use crate::mix::{lanes_of, placed, product_any};
use equip_scalar::{Float, Kernel};
use std::ops::Range;

/// Z = E L, or 0 without E, and the stages Y = y0 + Z; the largest |Y| of each component goes to `scale`. As many components as `z` has.
pub(crate) struct Start<'a, T> {
    /// E, column by column.
    pub(crate) prolongation: Option<&'a [T]>,
    /// L of the step before.
    pub(crate) l: &'a [T],
    pub(crate) hi: &'a [T],
    pub(crate) lo: &'a [T],
    pub(crate) z: &'a mut [T],
    pub(crate) points: &'a mut [T],
    pub(crate) scale: &'a mut [T],
    pub(crate) s: usize,
}

impl<T: Float> Kernel for Start<'_, T> {
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

impl<T: Float> Start<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let (s, components) = (self.s, self.hi.len());
        let (z, points) = (
            self.z.as_chunks_mut::<N>().0,
            self.points.as_chunks_mut::<N>().0,
        );
        let l = self.l.as_chunks::<N>().0;
        let groups = z.len() / components.max(1);
        for c in 0..components {
            let (hi, lo) = (self.hi[c], self.lo[c]);
            let mut size = [hi.abs(); N];
            let row = c * groups..(c + 1) * groups;
            for g in 0..groups {
                let guess = match self.prolongation {
                    Some(e) => product_any(e.as_chunks::<N>().0, &l[row.clone()], g, s),
                    None => [T::int(0); N],
                };
                let placed = placed(hi, lo, &guess);
                see(&mut size, &placed);
                z[row.start + g] = guess;
                points[row.start + g] = placed;
            }
            self.scale[c] = largest(size);
        }
    }
}

/// The same sizes for stages that are there already.
pub(crate) struct Sizes<'a, T> {
    pub(crate) hi: &'a [T],
    pub(crate) points: &'a [T],
    pub(crate) scale: &'a mut [T],
    pub(crate) s: usize,
}

impl<T: Float> Kernel for Sizes<'_, T> {
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

impl<T: Float> Sizes<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let points = self.points.as_chunks::<N>().0;
        let groups = points.len() / self.hi.len().max(1);
        let rows = points.chunks_exact(groups.max(1));
        for ((scale, &hi), row) in self.scale.iter_mut().zip(self.hi).zip(rows) {
            let mut size = [hi.abs(); N];
            for points in row {
                see(&mut size, points);
            }
            *scale = largest(size);
        }
    }
}

/// Raises the sizes of `components` to the least that is resolved, and takes their inverses.
#[inline(always)]
pub(crate) fn resolve<T: Float>(scale: &mut [T], inverse: &mut [T], components: Range<usize>) {
    let (m, root) = (scale.len() / 2, T::EPSILON.sqrt());
    for group in [0..m, m..2 * m] {
        let group = group.start.max(components.start)..group.end.min(components.end);
        if group.is_empty() {
            continue;
        }
        let (scale, inverse) = (&mut scale[group.clone()], &mut inverse[group]);
        let most = (scale.iter()).fold(T::int(0), |a, &x| if x > a { x } else { a });
        let least = if most > T::int(0) {
            most * root * root.sqrt()
        } else {
            T::int(1)
        };
        for (x, inverse) in scale.iter_mut().zip(inverse) {
            *x = if *x > least { *x } else { least };
            *inverse = T::int(1) / *x;
        }
    }
}

/// Lane by lane the larger of the size and |x|.
#[inline(always)]
fn see<T: Float, const N: usize>(size: &mut [T; N], x: &[T; N]) {
    for i in 0..N {
        let x = x[i].abs();
        size[i] = if x > size[i] { x } else { size[i] };
    }
}

/// The largest of all lanes.
#[inline(always)]
pub(crate) fn largest<T: Float, const N: usize>(mut x: [T; N]) -> T {
    let mut count = N;
    while count > 1 {
        count /= 2;
        for i in 0..count {
            x[i] = if x[i + count] > x[i] {
                x[i + count]
            } else {
                x[i]
            };
        }
    }
    x[0]
}
