//! A whole run with variable steps over an interval.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::options::adaptive::Adaptive;
use crate::options::record::Record;
use crate::runs::chaos_watch::chaos_of_run;
use crate::runs::dense_watch::DenseWatch;
use crate::runs::drive::{Schedule, Watchers, drive};
use crate::runs::observer::{NoObserver, Observer};
use crate::runs::run::{Run, RunFailure};
use crate::steppers::adaptive_stepper::AdaptiveStepper;
use crate::steppers::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use std::ops::RangeInclusive;

impl<T: Float> Adaptive<T> {
    /// Integrates from (`q0`, `p0`), each of length m, over `interval`.
    ///
    /// The last step meets the end of the interval; where a step of the proposed size would leave a sliver, the two last ones are equal.
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

    /// Goes on with the run that `checkpoint` was made of, to time `end`. The run that comes back begins at the checkpoint; its certificate is that of the
    /// whole. Steps are bit for bit those of the run that had not stopped, up to the two that meet the end: a checkpoint made after
    /// these goes on from there with steps of its own.
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

    /// A fixed step that would have met the tolerance everywhere between `t0` and `t1`: the smallest of the steps that the tolerance asks for there.
    ///
    /// # Errors
    /// Those of [`integrate`](Self::integrate).
    pub fn suggest_step<H: System>(
        &self,
        system: &H,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
    ) -> Result<T, IntegrateError<T>> {
        let mut options = self.clone();
        options.base.record = Record::Ends;
        let run = options
            .integrate(system, q0, p0, interval)
            .map_err(|failure| failure.error)?;
        let steps = run.certificate().variable_steps;
        Ok(steps.map_or(T::int(0), |steps| steps.smallest))
    }

    fn drive<H: System>(
        &self,
        system: &H,
        mut stepper: AdaptiveStepper<T, H::Evaluator<T>>,
        end: T,
        from: Option<&Checkpoint>,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let (times, now) = (&self.base.output_times, stepper.time());
        let times = &times[times.partition_point(|&t| t < now)..];
        let watchers = Watchers {
            record: self.base.record,
            outputs: None,
            dense: DenseWatch::new(system, &self.base, times, &mut stepper.inner)?,
            chaos: chaos_of_run(system, &self.base, &mut stepper.inner, from)?,
        };
        drive(&mut Until { stepper, end }, watchers, observer)
    }
}

/// A run with variable steps up to its end.
#[derive(Debug)]
struct Until<T: Float, E> {
    stepper: AdaptiveStepper<T, E>,
    end: T,
}

impl<T: Float, E: Evaluate<T>> Schedule<T, E> for Until<T, E> {
    fn stepper(&self) -> &Stepper<T, E> {
        &self.stepper.inner
    }

    fn time_low(&self) -> T {
        self.stepper.time_low
    }

    fn is_done(&self) -> bool {
        !(self.stepper.time() < self.end)
    }

    fn checkpoint(&mut self) -> Checkpoint {
        self.stepper.checkpoint()
    }

    fn advance(&mut self) -> Result<(), IntegrateError<T>> {
        self.stepper.advance_within(Some(self.end)).map(|_| ())
    }
}
