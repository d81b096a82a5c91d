//! [`Stepper`]: a run one step at a time.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::memory::Memory;
use crate::error::IntegrateError;
use crate::events::watch::EventsAt;
use crate::report::certificate::Certificate;
use crate::steppers::integration::Integration;
use crate::steppers::step_control::StepControl;
use crate::steppers::view::StepView;
use equip_scalar::Float;
use equip_solver::Counts;
use std::ops::ControlFlow;

/// A run that is advanced step by step: an endless iterator, or [`advance`](Self::advance) without copies.
#[derive(Debug)]
pub struct Stepper<T: Float> {
    pub(crate) inner: Integration<T>,
    pub(crate) control: Box<dyn StepControl<T>>,
}

impl<T: Float> Stepper<T> {
    pub(crate) fn begin(
        &mut self,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<(), IntegrateError<T>> {
        self.control.begin(&mut self.inner, start, t0, towards)
    }

    /// Begins a new run at (`q0`, `p0`), each of length m, at time `t0`, with the prepared data of this one.
    /// It agrees bit for bit with a run that has just been [started](crate::Integrator::start), and nothing
    /// is allocated. After an error the run is unchanged.
    ///
    /// # Errors
    /// Invalid initial values, or H not finite at the initial state.
    pub fn restart(&mut self, q0: &[T], p0: &[T], t0: T) -> Result<(), IntegrateError<T>> {
        self.begin((q0, p0), t0, None)
    }

    /// Moves the run to (`q`, `p`), each of length m, at the present time, as after a kick. H and the
    /// invariants are conserved at their new values from now on, and the next step does not depend on earlier
    /// steps. Counts, grid, the proposed size of the next step and the largest errors do not change. Nothing
    /// is allocated. After an error nothing changes.
    ///
    /// # Errors
    /// Invalid values, or H not finite at the state.
    pub fn set_state(&mut self, q: &[T], p: &[T]) -> Result<(), IntegrateError<T>> {
        let time = self.inner.time;
        self.inner.move_to(q, p, time)?;
        self.control.at_another_state(&mut self.inner);
        Ok(())
    }

    /// Moves the run to the state that events within its last step make of the state at their root, or breaks
    /// with this state if one of them ends the run. The end of the run does not change.
    ///
    /// # Errors
    /// Invalid values, or H not finite at the state.
    pub(crate) fn act(
        &mut self,
        at: EventsAt<'_, T>,
    ) -> Result<ControlFlow<Vec<T>>, IntegrateError<T>> {
        let EventsAt {
            events, time, y, ..
        } = at;
        let mut y = y.to_vec();
        if events.change(time, &mut y).is_break() {
            return Ok(ControlFlow::Break(y));
        }
        let (q, p) = y.split_at(y.len() / 2);
        let since = (time - self.inner.measured.state_changes.1).abs();
        let moved = self.inner.move_to(q, p, time).and_then(|()| {
            self.inner.time = time;
            self.control.at_another_time(&mut self.inner, since)
        });
        moved.map_err(|cause| IntegrateError::ChangedState {
            event: events.changing(),
            time,
            cause: cause.to_string(),
        })?;
        events.continue_changed(time);
        Ok(ControlFlow::Continue(()))
    }

    /// Reverses the direction of time of the following steps.
    pub fn turn_back(&mut self) {
        self.control.turn_back(&mut self.inner);
    }

    /// Makes the next step towards the time `t`, forward or backward, but not beyond `t`. Repeated while it
    /// returns `true`, it makes the steps of [`advance_to`](Self::advance_to), and the caller may stop after
    /// each step.
    ///
    /// # Errors
    /// A time that is not finite, or a step that fails.
    pub fn advance_towards(&mut self, t: T) -> Result<bool, IntegrateError<T>> {
        self.control.step_towards(&mut self.inner, t)
    }

    /// Steps must meet this time from now on.
    ///
    /// # Errors
    /// A time that is not finite, lies before the present stretch of the run, or cannot be met.
    pub(crate) fn set_end(&mut self, end: T) -> Result<(), IntegrateError<T>> {
        let run = &self.inner;
        if !end.is_finite() {
            let start = run.stretch_start();
            return Err(IntegrateError::Interval { start, end });
        }
        if run.direction.is_before(end, run.stretch_start()) {
            let step = self.inner.size.unwrap_or(run.last.0.abs());
            return Err(IntegrateError::StepsLeadAway {
                step: run.direction.signed(step),
                start: run.t0,
                end,
            });
        }
        self.control.set_end(run, end)
    }

    /// The present state of the run, to be resumed with the same options.
    pub fn checkpoint(&mut self) -> Checkpoint {
        let mut checkpoint = self.inner.checkpoint();
        let mut memory = Memory::to_write(&mut checkpoint.run);
        self.control.remember(&mut self.inner, &mut memory);
        checkpoint.seal();
        checkpoint
    }

    /// The last step, or the initial state.
    pub fn view(&self) -> StepView<'_, T> {
        self.inner.view()
    }

    /// The time reached.
    pub fn time(&self) -> T {
        self.inner.time
    }

    /// The size of the next step, without sign: the fixed size, or the size that step control proposes.
    pub fn next_step(&self) -> T {
        self.control.next_step()
    }

    /// The counts so far.
    pub fn counts(&self) -> &Counts {
        self.inner.core.counts()
    }

    /// The certificate of the run so far.
    pub fn certificate(&self) -> Certificate<T> {
        self.inner.certificate()
    }
}
