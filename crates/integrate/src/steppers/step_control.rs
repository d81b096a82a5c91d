//! [`StepControl`]: the rule for the sizes of steps.

use crate::checkpoints::memory::Memory;
use crate::error::IntegrateError;
use crate::steppers::integration::Integration;
use crate::time::direction::TimeDirection;
use equip_scalar::Float;
use std::fmt;

/// A rule for the sizes of steps, with its memory. It advances `run`.
pub(crate) trait StepControl<T: Float>: fmt::Debug + Send + Sync {
    /// Begins a new run at a state (q0, p0) and `t0`, in the direction of the time `towards` if it is known.
    ///
    /// # Errors
    /// Invalid initial states. The run is then unchanged.
    fn begin(
        &mut self,
        run: &mut Integration<T>,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<(), IntegrateError<T>>;

    /// Writes the memory of step control to the checkpoint of the run, or reads it. The run has been restored
    /// before.
    fn remember(&mut self, run: &mut Integration<T>, memory: &mut Memory<'_>);

    /// Steps must meet this time from now on.
    ///
    /// # Errors
    /// If they cannot.
    fn set_end(&mut self, run: &Integration<T>, end: T) -> Result<(), IntegrateError<T>>;

    /// Whether the end has been reached.
    fn is_done(&self, run: &Integration<T>) -> bool;

    /// Called if the run has been moved to another state at the same time.
    fn at_another_state(&mut self, run: &mut Integration<T>);

    /// Called if the run has been moved to another state and time within the last step, `since` after the
    /// start of the run or the last such change. The end does not change.
    ///
    /// # Errors
    /// If steps from there cannot meet the end.
    fn at_another_time(
        &mut self,
        run: &mut Integration<T>,
        since: T,
    ) -> Result<(), IntegrateError<T>>;

    /// Reverses the direction of time.
    fn turn_back(&mut self, run: &mut Integration<T>);

    /// Makes the next step, not beyond the end if `meets_end` and the end is known.
    ///
    /// # Errors
    /// If the step fails.
    fn step(&mut self, run: &mut Integration<T>, meets_end: bool) -> Result<(), IntegrateError<T>>;

    /// Makes the next step towards `t`, forward or backward, but not beyond `t`. Returns whether a step was
    /// needed.
    ///
    /// # Errors
    /// A time that is not finite, or a step that fails.
    fn step_towards(&mut self, run: &mut Integration<T>, t: T) -> Result<bool, IntegrateError<T>>;

    /// The rounding remainder of the time.
    fn time_low(&self) -> T;

    /// The size of the next step, without sign.
    fn next_step(&self) -> T;

    /// The time at the end of the next step if it is known. Outputs before it are then computed by separate
    /// steps.
    fn next_time(&self) -> Option<T>;
}

/// The direction from `t0` to `towards`; `None` if there is no such time or it equals `t0`.
///
/// # Errors
/// A time that is not finite.
pub(crate) fn way<T: Float>(
    t0: T,
    towards: Option<T>,
) -> Result<Option<TimeDirection>, IntegrateError<T>> {
    if !t0.is_finite() {
        let (start, end) = (t0, towards.unwrap_or(t0));
        return Err(IntegrateError::Interval { start, end });
    }
    Ok(towards.and_then(|end| TimeDirection::between(t0, end)))
}
