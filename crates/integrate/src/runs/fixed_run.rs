//! A whole run with fixed steps over an interval.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::options::fixed_step::FixedStep;
use crate::runs::chaos_watch::chaos_of_run;
use crate::runs::dense_watch::DenseWatch;
use crate::runs::drive::{Schedule, Watchers, drive};
use crate::runs::grid::Grid;
use crate::runs::observer::{NoObserver, Observer};
use crate::runs::outputs::Outputs;
use crate::runs::run::{Run, RunFailure};
use crate::steppers::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use std::ops::RangeInclusive;

impl<T: Float> FixedStep<T> {
    /// Integrates from (`q0`, `p0`), each of length m, over `interval`.
    ///
    /// The grid is t0 + n h; a last, shorter step reaches the end if h does not divide the interval.
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
        let grid = Grid::new(t0, t1, self.h)?;
        self.check_times(t0, t1)?;
        let stepper = self.start(system, q0, p0, t0)?;
        self.drive(system, stepper, grid, None, observer)
    }

    /// Goes on with the run that `checkpoint` was made of, to time `end`. The run that comes back begins at the checkpoint; its certificate is that of the
    /// whole. Steps are bit for bit those of the run that had not stopped.
    ///
    /// # Errors
    /// Those of [`resume`](Self::resume), a checkpoint that is not on the grid, and [`RunFailure`].
    pub fn integrate_from<H: System>(
        &self,
        system: &H,
        checkpoint: &Checkpoint,
        end: T,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        let stepper = self.resume(system, checkpoint)?;
        let grid = Grid::new(stepper.t0, end.max(stepper.time()), self.h)?;
        if stepper.index > grid.whole || grid.time(stepper.index) != stepper.time() {
            return Err(IntegrateError::CheckpointOffGrid {
                time: stepper.time(),
            }
            .into());
        }
        self.check_times(stepper.t0, end)?;
        self.drive(system, stepper, grid, Some(checkpoint), observer)
    }

    fn drive<H: System>(
        &self,
        system: &H,
        mut stepper: Stepper<T, H::Evaluator<T>>,
        grid: Grid<T>,
        from: Option<&Checkpoint>,
        observer: &mut impl Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        // The steps for output have a workspace of their own: the run must not feel them.
        let now = stepper.time();
        let times = &self.output_times[self.output_times.partition_point(|&t| t < now)..];
        let outputs = if times.is_empty() {
            None
        } else {
            let (q, p) = stepper.y.hi.split_at(stepper.y.hi.len() / 2);
            Some(Outputs {
                stepper: self.start(system, q, p, now)?,
                grid,
                times,
                done: 0,
            })
        };
        let watchers = Watchers {
            record: self.record,
            outputs,
            dense: DenseWatch::new(system, self, &[], &mut stepper)?,
            chaos: chaos_of_run(system, self, &mut stepper, from)?,
        };
        drive(&mut OnGrid { stepper, grid }, watchers, observer)
    }

    /// The interval, and the output times in it.
    pub(crate) fn check_times(&self, start: T, end: T) -> Result<(), IntegrateError<T>> {
        if !(end >= start) || !start.is_finite() || !end.is_finite() {
            return Err(IntegrateError::Interval { start, end });
        }
        let mut previous = start;
        for (index, &time) in self.output_times.iter().enumerate() {
            if !(time >= previous && time <= end) {
                return Err(IntegrateError::OutputTime {
                    time,
                    index,
                    start,
                    end,
                });
            }
            previous = time;
        }
        Ok(())
    }
}

/// A run on its grid.
#[derive(Debug)]
pub(crate) struct OnGrid<T: Float, E> {
    pub(crate) stepper: Stepper<T, E>,
    pub(crate) grid: Grid<T>,
}

impl<T: Float, E: Evaluate<T>> Schedule<T, E> for OnGrid<T, E> {
    fn stepper(&self) -> &Stepper<T, E> {
        &self.stepper
    }

    fn time_low(&self) -> T {
        T::int(0)
    }

    fn is_done(&self) -> bool {
        self.stepper.index >= self.grid.steps()
    }

    fn checkpoint(&mut self) -> Checkpoint {
        self.stepper.checkpoint()
    }

    fn advance(&mut self) -> Result<(), IntegrateError<T>> {
        let index = self.stepper.index + 1;
        let (time, h) = (self.grid.time(index), self.grid.size(index));
        self.stepper.advance_to(time, h).map(|_| ())
    }
}
