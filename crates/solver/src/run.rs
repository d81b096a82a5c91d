//! A whole run over an interval, and what it leaves.

use crate::certificate::Certificate;
use crate::checkpoint::Checkpoint;
use crate::dense_trajectory::Trajectory;
use crate::dense_watch::DenseWatch;
use crate::drive::{Watchers, drive};
use crate::error::IntegrateError;
use crate::event::Occurrence;
use crate::grid::{Grid, OnGrid, Outputs};
use crate::observer::{NoObserver, Observer};
use crate::options::FixedStep;
use crate::outcome::Outcome;
use crate::stepper::{StepView, Stepper};
use crate::tangent_chaos::Chaos;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use std::ops::RangeInclusive;

/// The states a run kept, and its certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct Run<T> {
    m: usize,
    times: Vec<T>,
    states: Vec<T>,
    energy_defects: Vec<T>,
    outcomes: Vec<Outcome>,
    output_times: Vec<T>,
    outputs: Vec<T>,
    pub(crate) trajectory: Option<Trajectory<T>>,
    pub(crate) occurrences: Vec<Occurrence<T>>,
    ended: Option<T>,
    stopped: bool,
    pub(crate) certificate: Certificate<T>,
}

/// A run that ended in an error, with all that was made before it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct RunFailure<T: Float> {
    /// What went wrong.
    #[source]
    pub error: IntegrateError<T>,
    /// The run up to the last good step; `None` if the fault was found before the first.
    pub partial: Option<Box<Run<T>>>,
}

impl<T: Float> From<IntegrateError<T>> for RunFailure<T> {
    fn from(error: IntegrateError<T>) -> Self {
        RunFailure {
            error,
            partial: None,
        }
    }
}

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
        // The last step of a run that is over may be shorter than the grid's.
        if stepper.index > grid.steps() || grid.time(stepper.index) != stepper.time() {
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
            chaos: Chaos::of_run(system, self, &mut stepper, from)?,
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

impl<T: Float> Run<T> {
    pub(crate) fn new<E: Evaluate<T>>(stepper: &Stepper<T, E>) -> Self {
        let mut run = Run {
            m: stepper.y.hi.len() / 2,
            times: Vec::new(),
            states: Vec::new(),
            energy_defects: Vec::new(),
            outcomes: Vec::new(),
            output_times: Vec::new(),
            outputs: Vec::new(),
            trajectory: None,
            occurrences: Vec::new(),
            ended: None,
            stopped: false,
            certificate: stepper.certificate(),
        };
        run.keep(&stepper.view());
        run
    }

    pub(crate) fn keep(&mut self, view: &StepView<'_, T>) {
        self.times.push(view.time);
        self.states.extend_from_slice(view.q);
        self.states.extend_from_slice(view.p);
        self.energy_defects.extend(view.energy_defect);
        self.outcomes.push(view.outcome);
    }

    /// The state at a time asked for.
    pub(crate) fn output(&mut self, time: T, y: &[T]) {
        self.output_times.push(time);
        self.outputs.extend_from_slice(y);
    }

    /// An observer ends the run here.
    pub(crate) fn stop(&mut self) {
        self.stopped = true;
    }

    /// A terminal event ends the run within the step made last.
    pub(crate) fn end_at<E: Evaluate<T>>(&mut self, time: T, y: &[T], stepper: &Stepper<T, E>) {
        let (q, p) = y.split_at(self.m);
        self.keep(&StepView {
            time,
            q,
            p,
            ..stepper.view()
        });
        self.ended = Some(time);
        self.stopped = true;
    }

    pub(crate) fn finish<E: Evaluate<T>>(&mut self, stepper: &Stepper<T, E>) {
        let (output_steps, chaos) = (self.certificate.output_steps, self.certificate.chaos);
        let certificate = stepper.certificate();
        self.certificate = Certificate {
            output_steps,
            chaos,
            end: self.ended.unwrap_or(certificate.end),
            ..certificate
        };
    }

    pub(crate) fn fail<E: Evaluate<T>>(
        mut self,
        error: IntegrateError<T>,
        stepper: &Stepper<T, E>,
    ) -> RunFailure<T> {
        if self.times.last() != Some(&stepper.time()) {
            self.keep(&stepper.view());
        }
        self.finish(stepper);
        RunFailure {
            error,
            partial: Some(Box::new(self)),
        }
    }

    /// Number of states kept, the initial one included.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// A run always keeps its initial state.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Times of the states kept.
    pub fn times(&self) -> &[T] {
        &self.times
    }

    /// Positions of state number `i`, length m.
    pub fn q(&self, i: usize) -> &[T] {
        &self.states[2 * self.m * i..][..self.m]
    }

    /// Momenta of state number `i`, length m.
    pub fn p(&self, i: usize) -> &[T] {
        &self.states[2 * self.m * i + self.m..][..self.m]
    }

    /// The last state: time, positions, momenta.
    pub fn last(&self) -> (T, &[T], &[T]) {
        let i = self.len() - 1;
        (self.times[i], self.q(i), self.p(i))
    }

    /// H − H_ref of the states kept; empty if the energy was not measured.
    pub fn energy_defects(&self) -> &[T] {
        &self.energy_defects
    }

    /// Outcomes of the steps that led to the states kept; that of the initial state means nothing.
    pub fn outcomes(&self) -> &[Outcome] {
        &self.outcomes
    }

    /// The states at the times asked for with [`FixedStep::output_at`]: time, positions, momenta.
    pub fn outputs(&self) -> impl Iterator<Item = (T, &[T], &[T])> {
        self.output_times
            .iter()
            .zip(self.outputs.chunks_exact(2 * self.m))
            .map(|(&t, y)| {
                let (q, p) = y.split_at(self.m);
                (t, q, p)
            })
    }

    /// The run at any time, if dense output was asked for.
    pub fn trajectory(&self) -> Option<&Trajectory<T>> {
        self.trajectory.as_ref()
    }

    /// The roots of the event functions, in the order of time.
    pub fn events(&self) -> &[Occurrence<T>] {
        &self.occurrences
    }

    /// Whether an observer or a terminal event ended the run before the end of the interval.
    pub fn stopped(&self) -> bool {
        self.stopped
    }

    /// What was kept, measured.
    pub fn certificate(&self) -> &Certificate<T> {
        &self.certificate
    }
}
