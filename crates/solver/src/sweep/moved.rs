//! What moves with the α's in the midst of a step: K, Z, and the stages.

use super::Iterate;
use crate::row::{add, by_lanes, difference, scaled};
use crate::state::State;
use equip_scalar::{Float, Kernel};

impl<T: Float> Iterate<T> {
    /// K is not the one a step starts from.
    pub(crate) fn k_has_moved(&self) -> bool {
        self.k_has_moved
    }

    /// K for these α's.
    pub(crate) fn set_alphas(&mut self, alphas: &[T]) {
        self.columns.fill(self.set, alphas, &mut self.k);
        self.k_has_moved = true;
        if let Some(twice) = &mut self.twice {
            twice.follow(self.set, &self.k, (&self.hb, self.s));
        }
    }

    /// After K has changed for the first time in the step: Z ← K L with the gradients there are. What Z was is kept.
    pub(crate) fn mix_anew(&mut self, y: &State<T>) {
        debug_assert!(!self.is_draft);
        self.z_before.copy_from_slice(&self.z);
        self.has_momenta = false;
        self.mix(y);
        self.is_of_l = true;
    }

    /// Sees to it that the stages of momenta are there too: by the linear half of the last sweep once more.
    pub(crate) fn keep_momenta(&mut self, y: &State<T>) {
        debug_assert!(!self.is_draft);
        if !std::mem::replace(&mut self.has_momenta, true) {
            self.mix(y);
        }
    }

    /// After K has changed again, by `share` of the first change: Z moves by this share of how it has moved since.
    pub(crate) fn extrapolate(&mut self, y: &State<T>, share: T) {
        let len = self.unknowns() * self.stride;
        if self.has_springs() {
            self.folded[..len].copy_from_slice(&self.z[..len]);
        }
        self.set.run(&mut Extrapolate {
            z: &mut self.z[..len],
            before: &self.z_before[..len],
            share,
            s: self.s,
        });
        self.follow();
        self.place(y);
        self.is_of_l = false;
    }

    /// Changes Z of each unknown component c in place by `change(c, Z_c)`, and the stages with it.
    /// On springs L is to follow ([`Iterate::follow_with`]).
    pub(crate) fn displace(&mut self, y: &State<T>, mut change: impl FnMut(usize, &mut [T])) {
        let unknowns = self.unknowns();
        let rows = self.z.chunks_exact_mut(self.stride).enumerate();
        rows.take(unknowns).for_each(|(c, z)| change(c, z));
        self.place(y);
        self.is_of_l = false;
    }
}

/// Z moves by a share of how it has moved.
struct Extrapolate<'a, T> {
    z: &'a mut [T],
    before: &'a [T],
    share: T,
    s: usize,
}

impl<T: Float> Kernel for Extrapolate<'_, T> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        by_lanes!(T, self.s, self)
    }
}

impl<T: Float> Extrapolate<'_, T> {
    #[inline(always)]
    fn lanes<const N: usize>(&mut self) {
        let before = self.before.as_chunks::<N>().0;
        for (z, before) in self.z.as_chunks_mut::<N>().0.iter_mut().zip(before) {
            let moved = difference(z, before);
            add(z, &scaled(&moved, self.share));
        }
    }
}
