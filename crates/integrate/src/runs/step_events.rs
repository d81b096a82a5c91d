//! [`StepEvents`]: events of a run that is advanced one step at a time.

use crate::dense::refine::Refiner;
use crate::error::IntegrateError;
use crate::events::watch::{EventWatch, EventsAt};
use crate::options::event::{Event, Occurrence};
use crate::steppers::stepper::Stepper;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

/// The events along a run that the caller advances step by step.
///
/// ```
/// use equip_autodiff::Hamiltonian;
/// use equip_integrate::{Equip, Event, StepEvents};
/// use std::ops::ControlFlow;
///
/// // A ball above a floor, which reverses its momentum.
/// let ball = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] + q[0])?;
/// let floor = Event::new("floor", |_, q: &[f64], _| q[0]).falling().then(|_, _, p| {
///     p[0] = -p[0];
///     ControlFlow::Continue(())
/// });
/// let mut run = Equip::stages(2).step(0.25).start(&ball, &[0.5], &[0.0], 0.0)?;
/// let mut events = StepEvents::new(&ball, &mut run, &[floor])?;
/// let mut bounces = Vec::new();
/// while run.time() < 10.0 {
///     run.advance()?;
///     bounces.extend(events.find(&mut run)?.iter().map(|bounce| bounce.time));
/// }
/// assert_eq!(bounces.len(), 5);
/// assert!(bounces.iter().zip([1.0, 3.0, 5.0, 7.0, 9.0]).all(|(t, exact)| (t - exact).abs() < 1e-13));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct StepEvents<T: Float> {
    refiner: Refiner<T>,
    events: EventWatch<T>,
    found: Vec<Occurrence<T>>,
    /// Number and end of the last step examined, and the rounding remainder of that time.
    seen: (u64, T, T),
}

impl<T: Float> StepEvents<T> {
    /// Finds the roots of `events` from the next step of `run` on. `run` must belong to the same `system`.
    ///
    /// # Errors
    /// If the tables of the polynomial of a step cannot be computed.
    pub fn new(
        system: &Hamiltonian,
        run: &mut Stepper<T>,
        events: &[Event<T>],
    ) -> Result<Self, IntegrateError<T>> {
        let low = run.control.time_low();
        let stepper = &mut run.inner;
        stepper.core.keep_parts();
        let from = (stepper.time, stepper.direction);
        Ok(StepEvents {
            refiner: Refiner::new(system, stepper.core.method())?,
            events: EventWatch::new(events, 2 * stepper.m, from),
            found: Vec::new(),
            seen: (stepper.index, stepper.time, low),
        })
    }

    /// The events within the last step of `run`, in the order of the run, up to the first one that is
    /// terminal or changes the state. An event that changes the state moves the run to the changed state, at
    /// the time of the event. If its action breaks, the run stays at the end of its step.
    ///
    /// # Errors
    /// [`IntegrateError::StepsNotFollowed`] if the run has made several steps since the last call,
    /// [`IntegrateError::EventTooRough`] if a function changes sign more often than rounding lets us resolve,
    /// and errors of a changed state.
    pub fn find(&mut self, run: &mut Stepper<T>) -> Result<&[Occurrence<T>], IntegrateError<T>> {
        self.found.clear();
        let (index, end, low) = self.seen;
        let made = run.inner.index;
        let steps = made.checked_sub(index).unwrap_or(made);
        let stepper = &run.inner;
        match steps {
            0 => return Ok(&self.found),
            1 => {}
            _ => return Err(IntegrateError::StepsNotFollowed { steps }),
        }
        self.events.go(stepper.direction, end);
        let mut time_low = low;
        // A run that was restarted begins at another time.
        if let Some(first) = stepper.parts().first().filter(|part| part.time != end) {
            self.events.begin(first.time);
            time_low = T::int(0);
        }
        let mut ended = None;
        for ((part, state), end) in stepper.parts_to_ends().zip(stepper.times_of_ends()) {
            let method = stepper.core.method();
            let (piece, _) = self.refiner.refine((method, part), time_low, state);
            if let Some(place) = self.events.see((&piece, end), &mut self.found)? {
                ended = Some((part.clone(), piece, place));
                break;
            }
        }
        if let Some((part, piece, place)) = ended {
            let events = &mut self.events;
            let found = run.inner.step_to_event(&part, (&piece, place), events);
            let (time, step) = (found.time, (found.h, found.outcome));
            events.move_met(&mut self.found, time, found.y.split_at(run.inner.m));
            let at = EventsAt {
                events,
                time,
                y: &found.y,
                step,
            };
            // If its action breaks, the run stays at the end of its step.
            if run.act(at)?.is_continue() {
                run.inner.end_with(step);
            }
        }
        self.seen = (made, run.time(), run.control.time_low());
        Ok(&self.found)
    }
}
