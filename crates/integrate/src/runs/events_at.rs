//! [`EventsAt`]: events within a step that end the run or change its state.

use crate::error::IntegrateError;
use crate::events::watch::EventWatch;
use crate::steppers::stepper::Stepper;
use equip_scalar::Float;
use std::ops::ControlFlow;

/// Events, with the time and the state of their common root.
pub(crate) struct EventsAt<'a, T: Float> {
    pub(crate) events: &'a mut EventWatch<T>,
    pub(crate) time: T,
    pub(crate) y: &'a [T],
}

impl<T: Float> EventsAt<'_, T> {
    /// Moves the run to the state that the events make of the state at their root, or breaks with this state
    /// if one of them ends the run.
    ///
    /// # Errors
    /// A state from which the run cannot continue. The run has then not moved.
    pub(crate) fn act(
        self,
        steps: &mut Stepper<T>,
    ) -> Result<ControlFlow<Vec<T>>, IntegrateError<T>> {
        let EventsAt { events, time, y } = self;
        let mut y = y.to_vec();
        if events.change(time, &mut y).is_break() {
            return Ok(ControlFlow::Break(y));
        }
        match steps.kick(y.split_at(y.len() / 2), time) {
            Ok(()) => {
                events.continue_changed(time);
                Ok(ControlFlow::Continue(()))
            }
            Err(cause) => Err(IntegrateError::ChangedState {
                event: events.changing(),
                time,
                cause: cause.to_string(),
            }),
        }
    }
}
