//! How a step begins: at Z = 0, or from the last step's gradients.

use super::{Form, Iterate, form};
use crate::opening::Opening;
use crate::prolongation::Prolongation;
use crate::start::{Foretell, Resolve, Sizes};
use crate::state::State;
use equip_scalar::Float;
use equip_tableau::Gauss;
use std::ops::Range;

impl<T: Float> Iterate<T> {
    /// A step of size `h` begins at `y` with the α's to start from, at Z = 0.
    pub(crate) fn begin(&mut self, gauss: &Gauss<T>, (y, h): (&State<T>, T)) {
        self.set_step(gauss, h);
        let len = self.unknowns() * self.stride;
        self.z[..len].fill(T::int(0));
        self.place(y);
        self.measure(y, 0..self.unknowns());
        (self.is_first, self.is_prolonged, self.was_far) = (true, false, false);
    }

    fn set_step(&mut self, gauss: &Gauss<T>, h: T) {
        if self.h != h {
            self.h = h;
            for (hb, &b) in self.hb.iter_mut().zip(gauss.weights()) {
                *hb = h * b;
            }
        }
        if std::mem::take(&mut self.k_has_moved) {
            self.k.copy_from_slice(&self.k_start);
        }
    }

    /// The same, `ratio` times as long as the last step, from the gradients that the L of that foretells.
    pub(crate) fn begin_from_last(
        &mut self,
        gauss: &Gauss<T>,
        (y, h, ratio): (&State<T>, T, T),
        prolongation: &Prolongation<T>,
        known: Option<&[T]>,
    ) {
        self.set_step(gauss, h);
        std::mem::swap(&mut self.l, &mut self.l_before);
        (self.is_first, self.is_prolonged, self.was_far) = (true, true, false);
        (self.is_draft, self.has_momenta) = (false, true);
        if T::IS_DOUBLE
            && !self.has_springs()
            && self.open((y, ratio), prolongation, known).is_some()
        {
            return;
        }
        let (wanted, springs) = (self.unknowns(), self.has_springs());
        self.set.run(&mut Foretell {
            prolongation: prolongation.view(),
            l: &self.l_before,
            known,
            gradients: &mut self.gradients,
            hb: &self.hb,
            // On springs the last step as it is, or what is slow in it.
            ratio: (!springs).then_some(ratio),
            m: self.n / 2,
            wanted,
            s: self.s,
        });
        self.foresee_from_last(y, T::int(1) / ratio, prolongation, known);
        self.mix(y);
        self.measure(y, 0..self.n);
    }

    /// All of this as one kernel, if there is one for these lengths.
    fn open(
        &mut self,
        (y, ratio): (&State<T>, T),
        prolongation: &Prolongation<T>,
        known: Option<&[T]>,
    ) -> Option<()> {
        macro_rules! opening {
            ($task:expr) => {
                Opening {
                    sweep: $task.in_doubles()?,
                    prolongation: prolongation.view().in_doubles()?,
                    l: T::as_doubles(&self.l_before)?,
                    ratio: ratio.to_f64(),
                    known: match known {
                        Some(known) => Some(T::as_doubles(known)?),
                        None => None,
                    },
                    scale: T::as_doubles_mut(&mut self.scale)?,
                    inverse_scale: T::as_doubles_mut(&mut self.inverse_scale)?,
                }
                .run(self.set)
            };
        }
        // The change of Z from what it was in the last step is nobody's concern.
        let nothing = [T::int(0); 4];
        match form!(self, y, &nothing) {
            Form::Whole(task) => opening!(task),
            Form::Half(task) => opening!(task),
            // No step begins by one.
            Form::Draft(_) => None,
        }
    }

    /// Measures components by their stages.
    pub(crate) fn measure(&mut self, y: &State<T>, components: Range<usize>) {
        let stride = self.stride;
        self.set.run(&mut Sizes {
            hi: &y.hi[components.clone()],
            points: &self.points[components.start * stride..components.end * stride],
            scale: &mut self.scale[components.clone()],
            s: self.s,
        });
        self.set.run(&mut Resolve {
            scale: &mut self.scale,
            inverse: &mut self.inverse_scale,
            components,
        });
    }
}
