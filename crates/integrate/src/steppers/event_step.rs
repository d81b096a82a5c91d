//! [`EventStep`]: a step that ends at an event (docs/adr/0036).
//!
//! The polynomial of a step has the order of the step, but it conserves neither H nor the invariants. A step
//! in which an event ends the run or changes its state is therefore repeated so that it ends at the event.
//! Its size is the position of the root on the polynomial, corrected by Newton's method: g at the end of the
//! step, divided by the derivative of g on the polynomial.
//!
//! Cost: two steps for most events, each with the last one as initial guess.

use crate::control::policy::MOST_TRIES;
use crate::dense::piece::Piece;
use crate::events::watch::{EventWatch, ROUNDINGS};
use crate::report::measured::LastStep;
use crate::steppers::integration::Integration;
use crate::time::visible::visible;
use equip_scalar::Float;
use equip_solver::{Outcome, Part, State};

/// A step from the start of a part of the last step to the events met.
#[derive(Debug)]
pub(crate) struct EventStep<T: Float> {
    pub(crate) time: T,
    /// (q, p) at its end.
    pub(crate) y: Vec<T>,
    pub(crate) h: T,
    pub(crate) outcome: Outcome,
    /// The step and its end. `None` if the state is on the polynomial, since no step ends at the events.
    pub(crate) made: Option<(Part<T>, State<T>)>,
}

impl<T: Float> Integration<T> {
    /// Repeats `part` of the last step so that it ends at the root of the events met, which is at `place` on
    /// its `piece`. The state of the run does not change.
    pub(crate) fn step_to_event(
        &mut self,
        part: &Part<T>,
        (piece, place): (&Piece<T>, T),
        events: &mut EventWatch<T>,
    ) -> EventStep<T> {
        let made = self.try_sizes(part, (piece, place), events);
        let step = match made {
            Some((size, outcome)) => {
                let last = LastStep {
                    y: &self.next.hi,
                    m: self.m,
                    time: piece.time_at(size),
                    h: size * part.h,
                    elapsed: (piece.time_at(size) - self.t0).abs(),
                    outcome,
                    h_ref: self.h_ref,
                };
                self.measured.see(&mut self.core, &last, &mut self.gradient);
                let part = self.core.parts().last().cloned();
                (size, outcome, part.map(|part| (part, self.next.clone())))
            }
            None => {
                piece.state_at(place, &mut self.next.hi);
                let error = self.core.energy_at(&self.next.hi) - self.h_ref;
                let is_beyond = self.measured.see_on_polynomial(error);
                // No α moves the polynomial.
                let outcome = if is_beyond {
                    Outcome::NoEffect
                } else {
                    self.last.1
                };
                (place, outcome, None)
            }
        };
        self.core.forget();
        let (size, outcome, made) = step;
        let (q, p) = visible(&self.next.hi, self.m);
        EventStep {
            time: piece.time_at(size),
            y: [q, p].concat(),
            h: size * part.h,
            outcome,
            made,
        }
    }

    /// The last step of the run ends at an event, with this size and this outcome.
    pub(crate) fn end_with(&mut self, (h, outcome): (T, Outcome)) {
        self.core.counts_mut().replace(self.last.1, outcome);
        self.last = (h, outcome);
    }

    /// The size of a step that ends at the events met, relative to `part`, and its outcome. `None` if no size
    /// is found, or if the step crosses a root that the polynomial does not cross.
    fn try_sizes(
        &mut self,
        part: &Part<T>,
        (piece, place): (&Piece<T>, T),
        events: &mut EventWatch<T>,
    ) -> Option<(T, Outcome)> {
        events.compare_with(piece, place);
        let (from, mut size, mut before) = (&part.start, place, T::int(1));
        self.core.refuse();
        self.core.guess_from(&part.l, part.h);
        for _ in 0..MOST_TRIES {
            let (time, h) = (piece.time_at(size), size * part.h);
            let mut outcome = self.core.step(from, part.time, h, &mut self.next).ok()?;
            if self.core.defers_alphas() {
                outcome = (self.core)
                    .complete(from, part.time, h, &mut self.next)
                    .ok()?;
            }
            let [correction, spread] = events.corrections(time, visible(&self.next.hi, self.m))?;
            let by = correction.abs();
            // Where the derivative of g is small, the corrections end in the rounding of g.
            let rests = by >= before && by * by <= T::EPSILON;
            let is_noise = rests && spread <= T::int(4) * before;
            if is_noise || self.is_rounding(from, (by + spread) / size) {
                return (self.core.parts().len() == 1).then_some((size, outcome));
            }
            (size, before) = (size + correction, by);
            if !(size > T::int(0) && size <= T::int(1)) {
                return None;
            }
            self.core.refuse();
        }
        None
    }

    /// Whether such a relative change of the size of the step from `from` to `next` is rounding of the state.
    fn is_rounding(&self, from: &State<T>, change: T) -> bool {
        let (start, end) = (&from.hi, &self.next.hi);
        let half = end.len() / 2;
        let halves = start.chunks(half).zip(end.chunks(half));
        halves.into_iter().all(|(start, end)| {
            let size = end.iter().fold(T::int(0), |size, y| size.max(y.abs()));
            let mut moved = start.iter().zip(end).map(|(&a, &b)| (b - a).abs());
            moved.all(|moved| change * moved <= T::int(ROUNDINGS) * T::EPSILON * size)
        })
    }
}
