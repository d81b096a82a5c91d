//! What a sweep does besides for components on stiff springs.

use super::Iterate;
use crate::foresee::{From, Last};
use crate::outcome::Counts;
use crate::prolongation::Prolongation;
use crate::springs::Springs;
use crate::state::State;
use equip_autodiff::Evaluate;
use equip_scalar::Float;
use equip_tableau::Gauss;

impl<T: Float> Iterate<T> {
    /// A step of size `h` begins at `y`: with springs, or without.
    pub(crate) fn begin_springs<E: Evaluate<T>>(
        &mut self,
        gauss: &Gauss<T>,
        energy: &mut E,
        (y, h): (&State<T>, T),
        counts: &mut Counts,
    ) {
        if let Some(springs) = &mut self.springs {
            springs.begin(gauss, energy, (&y.hi, h), counts);
        }
    }

    /// The springs of this step, if it is made with them.
    pub(crate) fn active_springs(&self) -> Option<&Springs<T>> {
        active(&self.springs)
    }

    /// Whether this step is made with springs.
    pub(crate) fn has_springs(&self) -> bool {
        self.active_springs().is_some()
    }

    /// Adds to the gradients on springs what they are about to change by: from Z = 0, or from Z as it was made by L.
    pub(crate) fn foresee(&mut self, y: &State<T>, from_nothing: bool) {
        if let (Some(springs), Some(kinetic)) = (active(&self.springs), &self.kinetic) {
            let from = if from_nothing {
                From::Nothing(&y.hi, kinetic.offset())
            } else {
                From::Made(&self.l)
            };
            springs.foresee(self.set, from, (&self.hb, &mut self.gradients), self.s);
        }
    }

    /// Makes the gradients on springs from the last step, `ratio` times as long as this one, and adds what they change by from Z = 0.
    pub(super) fn foresee_from_last(
        &mut self,
        y: &State<T>,
        ratio: T,
        prolongation: &Prolongation<T>,
        known: Option<&[T]>,
    ) {
        if let (Some(springs), Some(kinetic)) = (active(&self.springs), &self.kinetic) {
            let last = Last {
                prolongation: prolongation.view(),
                l: &self.l_before,
                ratio,
                known,
            };
            let from = From::Last(&y.hi, kinetic.offset(), last);
            springs.foresee(self.set, from, (&self.hb, &mut self.gradients), self.s);
        }
    }

    /// Z has been moved by so many times what was made with `made`, which has a row for each change of each spring: so are the forces foreseen.
    pub(crate) fn follow_with(&mut self, changes: &[T], made: &[T]) {
        let Some(springs) = active(&self.springs) else {
            return;
        };
        let (stride, m) = (self.stride, self.n / 2);
        let rows = made.chunks_exact(changes.len() * stride);
        for (spring, rows) in springs.springs.iter().zip(rows) {
            let l = &mut self.l[(spring.c + m) * stride..][..stride];
            for (&change, row) in changes.iter().zip(rows.chunks_exact(stride)) {
                l.iter_mut().zip(row).for_each(|(l, &x)| *l += change * x);
            }
        }
    }

    /// Z has been moved from what is in `folded`: the forces foreseen follow.
    pub(super) fn follow(&mut self) {
        let (stride, m) = (self.stride, self.n / 2);
        for spring in active(&self.springs).map_or(&[][..], |springs| &springs.springs) {
            let (q, p) = (spring.c * stride, (spring.c + m) * stride);
            for (i, &hb) in self.hb.iter().enumerate() {
                let moved = self.z[q + i] - self.folded[q + i];
                self.l[p + i] -= hb * (spring.kappa * moved);
            }
        }
    }
}

fn active<T: Float>(springs: &Option<Springs<T>>) -> Option<&Springs<T>> {
    springs.as_ref().filter(|springs| springs.is_active)
}
