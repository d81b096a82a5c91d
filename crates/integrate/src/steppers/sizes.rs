//! [`Sizes`]: from step sizes to the stepper that makes them.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::options::common::Words;
use crate::options::integrator::Integrator;
use crate::steppers::stepper::Stepper;
use crate::tangent::steps::sealed::Followed;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use equip_solver::{Core, Part};
use std::fmt;

/// What [`StepSizes`](crate::StepSizes) say of the steps.
pub trait Sizes<T: Float>: Clone + fmt::Debug + 'static {
    /// What makes the steps.
    type Stepper: Advance<T>;

    /// A stepper without a start: options checked, tables and workspace made.
    #[doc(hidden)]
    fn stepper(
        integrator: &Integrator<T, Self>,
        system: &Hamiltonian,
    ) -> Result<Self::Stepper, IntegrateError<T>>;

    /// The sizes in words: what has to be the same again for a checkpoint to fit.
    #[doc(hidden)]
    fn words(&self) -> Vec<(&'static str, String)>;
}

impl<T: Float, S: Sizes<T>> Integrator<T, S> {
    /// The run that `checkpoint` was made of, at the step where it was made.
    pub(crate) fn resumed(
        &self,
        system: &Hamiltonian,
        checkpoint: &Checkpoint,
    ) -> Result<S::Stepper, IntegrateError<T>> {
        checkpoint.check::<T>(&self.words())?;
        let mut stepper = S::stepper(self, system)?;
        // H(t, q, p) may be none at another pair of time and state.
        let (q, p) = checkpoint.start_state()?;
        let t0 = checkpoint.start.read_finite("the start")?;
        stepper.begin((&q, &p), t0, None)?;
        stepper.inner_mut().check_functions(checkpoint)?;
        stepper.restore(checkpoint)?;
        Ok(stepper)
    }

    /// Method, sizes and options in words.
    pub(crate) fn words(&self) -> Words {
        let mut words = self.sizes.words();
        words.extend(self.options.words(self.method));
        words
    }
}

impl<T: Float, S: Advance<T>> Followed<T> for S {
    fn core(&self) -> &Core<T> {
        &self.inner().core
    }

    fn core_mut(&mut self) -> &mut Core<T> {
        &mut self.inner_mut().core
    }

    fn parts_made(&self) -> &[Part<T>] {
        self.inner().parts()
    }

    fn time_reached(&self) -> T {
        self.inner().time
    }

    fn steps_made(&self) -> u64 {
        self.inner().index
    }

    fn step_to(&mut self, t: T) -> Result<bool, IntegrateError<T>> {
        self.step_towards(t)
    }
}

/// What steppers of all step sizes have in common, as whole runs and preparations use it.
pub trait Advance<T: Float> {
    /// State, references and defects.
    fn inner(&self) -> &Stepper<T>;
    /// The same, to be asked for the parts of its steps.
    fn inner_mut(&mut self) -> &mut Stepper<T>;
    /// Begins anew at a state (q0, p0) and `t0`, to go `towards` a time if that is known.
    ///
    /// # Errors
    /// Faults of the start, for which the run stays as it was.
    fn begin(
        &mut self,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<(), IntegrateError<T>>;
    /// Goes on where the run of `checkpoint` was; it has begun where that began.
    ///
    /// # Errors
    /// When the checkpoint is damaged.
    fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), IntegrateError<T>>;
    /// The run in its present state.
    fn save(&mut self) -> Checkpoint;
    /// Steps are to meet this time from now on.
    ///
    /// # Errors
    /// When they cannot.
    fn set_end(&mut self, end: T) -> Result<(), IntegrateError<T>>;
    /// Whether the end is reached.
    fn is_done(&self) -> bool;
    /// Puts the run at the state (q, p) at time `t`, which lies within the step made last: as
    /// [`Stepper::set_state`] does at its end. The end stays.
    ///
    /// # Errors
    /// Faults of the values, and an H that is not finite there.
    fn kick(&mut self, state: (&[T], &[T]), t: T) -> Result<(), IntegrateError<T>>;
    /// Makes the next step, whatever the end.
    ///
    /// # Errors
    /// When it cannot be made.
    fn go_on(&mut self) -> Result<(), IntegrateError<T>>;
    /// Makes the next step, up to the end.
    ///
    /// # Errors
    /// When it cannot be made.
    fn step(&mut self) -> Result<(), IntegrateError<T>>;
    /// Makes the next step towards `t`, forward or back, but not beyond it. Returns whether there was one to
    /// make.
    ///
    /// # Errors
    /// A time that is not finite, and a step that cannot be made.
    fn step_towards(&mut self, t: T) -> Result<bool, IntegrateError<T>>;
    /// What rounding lost of the time.
    fn time_low(&self) -> T;
    /// Time at the end of the next step where that is known, and outputs before it take steps of their own.
    fn next_time(&self) -> Option<T> {
        None
    }
}
