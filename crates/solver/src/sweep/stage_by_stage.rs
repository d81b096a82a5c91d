//! What Newton's method takes from the sweeps and they from it: stage by stage, in blocks of length n.

use super::Iterate;
use crate::state::State;
use equip_scalar::Float;

impl<T: Float> Iterate<T> {
    /// Takes over L of a step that was solved stage by stage, blocks of length n.
    pub(crate) fn take_l(&mut self, l: &[T]) {
        for (i, l) in l.chunks_exact(self.n).enumerate() {
            for (c, &l) in l.iter().enumerate() {
                self.l[c * self.stride + i] = l;
            }
        }
    }

    /// L stage by stage, in blocks of length n.
    pub(crate) fn give_l(&self, l: &mut [T]) {
        self.give(&self.l, l);
    }

    /// The same of the step before, from which this one was begun.
    pub(crate) fn give_l_before(&self, l: &mut [T]) {
        self.give(&self.l_before, l);
    }

    fn give(&self, from: &[T], to: &mut [T]) {
        for (i, block) in to.chunks_exact_mut(self.n).enumerate() {
            for (c, x) in block.iter_mut().enumerate() {
                *x = from[c * self.stride + i];
            }
        }
    }

    /// The stage increments Z, stage by stage in blocks of length n; those of momenta that are no unknowns from their stages.
    pub(crate) fn give_z(&mut self, y: &State<T>, z: &mut [T]) {
        self.keep_momenta(y);
        for (i, z) in z.chunks_exact_mut(self.n).enumerate() {
            for (c, z) in z.iter_mut().enumerate() {
                let place = c * self.stride + i;
                *z = if c < self.unknowns() {
                    self.z[place]
                } else {
                    (self.points[place] - y.hi[c]) - y.lo[c]
                };
            }
        }
    }
}
