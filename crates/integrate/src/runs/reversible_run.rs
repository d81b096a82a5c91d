//! A whole run with reversible steps over an interval.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::options::reversible::Reversible;
use crate::runs::chaos_watch::chaos_of_run;
use crate::runs::dense_watch::DenseWatch;
use crate::runs::drive::{Schedule, Watchers, drive};
use crate::runs::observer::{NoObserver, Observer};
use crate::runs::run::{Run, RunFailure};
use crate::steppers::reversible_stepper::ReversibleStepper;
use crate::steppers::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use std::ops::RangeInclusive;

impl<T: Float> Reversible<T> {
    /// Integrates from (`q0`, `p0`), each of length m, over `interval`. The last step is cut to meet the end.
    ///
    /// # Errors
    /// [`RunFailure`], which carries the part that was made.
    pub fn integrate<H: System>(
        &self,
        system: &H,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        self.integrate_observed(system, q0, p0, interval, &mut NoObserver)
    }

    /// The same, with an observer that sees every step and may end the run.
    ///
    /// # Errors
    /// [`RunFailure`], which carries the part that was made.
    pub fn integrate_observed<H: System>(
        &self,
        system: &H,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let (t0, t1) = interval.into_inner();
        self.base.check_times(t0, t1)?;
        let stepper = self.start(system, q0, p0, t0)?;
        self.drive(system, stepper, t1, None, observer)
    }

    /// Goes on with the run that `checkpoint` was made of, to time `end`; see
    /// [`Adaptive::integrate_from`](crate::Adaptive::integrate_from).
    ///
    /// # Errors
    /// Those of [`resume`](Self::resume), and [`RunFailure`].
    pub fn integrate_from<H: System>(
        &self,
        system: &H,
        checkpoint: &Checkpoint,
        end: T,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let stepper = self.resume(system, checkpoint)?;
        self.base.check_times(stepper.inner.t0, end)?;
        self.drive(system, stepper, end, Some(checkpoint), observer)
    }

    fn drive<H: System>(
        &self,
        system: &H,
        mut stepper: ReversibleStepper<T, H::Evaluator<T>>,
        end: T,
        from: Option<&Checkpoint>,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let (times, now) = (&self.base.output_times, stepper.inner.time());
        let times = &times[times.partition_point(|&t| t < now)..];
        let watchers = Watchers {
            record: self.base.record,
            outputs: None,
            dense: DenseWatch::new(system, &self.base, times, &mut stepper.inner)?,
            chaos: chaos_of_run(system, &self.base, &mut stepper.inner, from)?,
        };
        stepper.end = end;
        drive(&mut stepper, watchers, observer)
    }
}

impl<T: Float, E: Evaluate<T>> Schedule<T, E> for ReversibleStepper<T, E> {
    fn stepper(&self) -> &Stepper<T, E> {
        &self.inner
    }

    fn time_low(&self) -> T {
        self.time_low
    }

    fn is_done(&self) -> bool {
        !(self.inner.time() < self.end)
    }

    fn checkpoint(&mut self) -> Checkpoint {
        ReversibleStepper::checkpoint(self)
    }

    fn advance(&mut self) -> Result<(), IntegrateError<T>> {
        ReversibleStepper::advance(self).map(|_| ())
    }
}
