//! [`StepControl`]: how a run sizes its steps.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::steppers::integration::Integration;
use crate::time::direction::TimeDirection;
use equip_scalar::Float;
use std::fmt;

/// A rule for the sizes of steps, with what it remembers from step to step. It makes the steps of `run`.
pub(crate) trait StepControl<T: Float>: fmt::Debug + Send + Sync {
    /// Begins anew at a state (q0, p0) and `t0`, to go `towards` a time if that is known.
    ///
    /// # Errors
    /// Faults of the initial state, for which the run stays as it was.
    fn begin(
        &mut self,
        run: &mut Integration<T>,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<(), IntegrateError<T>>;

    /// Continues where the run of `checkpoint` was; it has begun where that began.
    ///
    /// # Errors
    /// When the checkpoint is damaged.
    fn restore(
        &mut self,
        run: &mut Integration<T>,
        checkpoint: &Checkpoint,
    ) -> Result<(), IntegrateError<T>>;

    /// Writes its memory into the checkpoint of the run.
    fn remember(&self, run: &Integration<T>, checkpoint: &mut Checkpoint);

    /// Steps are to meet this time from now on.
    ///
    /// # Errors
    /// When they cannot.
    fn set_end(&mut self, run: &Integration<T>, end: T) -> Result<(), IntegrateError<T>>;

    /// Whether the end is reached.
    fn is_done(&self, run: &Integration<T>) -> bool;

    /// The run is at another state, at the time that it had reached.
    fn at_another_state(&mut self, run: &mut Integration<T>);

    /// The run is at another state and at another time, within the step made last. The end stays.
    ///
    /// # Errors
    /// When steps from there cannot meet the end.
    fn at_another_time(&mut self, run: &mut Integration<T>) -> Result<(), IntegrateError<T>>;

    /// Turns the run round in time.
    fn turn_back(&mut self, run: &mut Integration<T>);

    /// Makes the next step, up to the end if `meets_end` and the end is known.
    ///
    /// # Errors
    /// When it cannot be made.
    fn step(&mut self, run: &mut Integration<T>, meets_end: bool) -> Result<(), IntegrateError<T>>;

    /// Makes the next step towards `t`, forward or back, but not beyond it. Returns whether there was one to
    /// make.
    ///
    /// # Errors
    /// A time that is not finite, and a step that cannot be made.
    fn step_towards(&mut self, run: &mut Integration<T>, t: T) -> Result<bool, IntegrateError<T>>;

    /// What rounding lost of the time.
    fn time_low(&self) -> T;

    /// Size of the next step, without a sign.
    fn next_step(&self) -> T;

    /// Time at the end of the next step where that is known, and outputs before it take steps of their own.
    fn next_time(&self) -> Option<T>;
}

/// Which way leads from `t0` towards a time, if one is given and is not `t0`.
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
