//! A complete run over an interval, and its results.

use crate::dense::trajectory::Trajectory;
use crate::error::IntegrateError;
use crate::options::event::Occurrence;
use crate::report::certificate::Certificate;
use crate::steppers::integration::Integration;
use crate::steppers::view::StepView;
use crate::time::visible::visible;
use equip_scalar::Float;
use equip_solver::Outcome;

/// The stored states of a run, and its certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct Run<T> {
    m: usize,
    times: Vec<T>,
    states: Vec<T>,
    energy_errors: Vec<T>,
    outcomes: Vec<Outcome>,
    pub(crate) output_times: Vec<T>,
    outputs: Vec<T>,
    pub(crate) trajectory: Option<Trajectory<T>>,
    pub(crate) occurrences: Vec<Occurrence<T>>,
    ended: Option<T>,
    pub(crate) stopped: bool,
    pub(crate) certificate: Certificate<T>,
}

/// A run that ended in an error, with all results before the error.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct RunFailure<T: Float> {
    /// The error.
    #[source]
    pub error: IntegrateError<T>,
    /// The run up to the last successful step; `None` if the error occurred before the first step.
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

impl<T: Float> Run<T> {
    pub(crate) fn new(stepper: &Integration<T>) -> Self {
        let mut run = Run {
            m: stepper.m,
            times: Vec::new(),
            states: Vec::new(),
            energy_errors: Vec::new(),
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
        self.energy_errors.extend(view.energy_error);
        self.outcomes.push(view.outcome);
    }

    /// Stores the state at a requested time.
    pub(crate) fn output(&mut self, time: T, y: &[T]) {
        self.output_times.push(time);
        let (q, p) = visible(y, self.m);
        self.outputs.extend_from_slice(q);
        self.outputs.extend_from_slice(p);
    }

    /// Ends the run within the last step, by a terminal event.
    pub(crate) fn end_at(&mut self, time: T, y: &[T], stepper: &Integration<T>) {
        self.drop_outputs_beyond(time, stepper);
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

    pub(crate) fn finish(&mut self, stepper: &Integration<T>) {
        let (output_steps, chaos) = (self.certificate.output_steps, self.certificate.chaos);
        let coarse_outputs = self.certificate.coarse_outputs;
        self.certificate = Certificate {
            output_steps,
            coarse_outputs,
            chaos,
            end: self.ended.unwrap_or(stepper.time),
            ..stepper.certificate()
        };
    }

    /// Drops outputs beyond `end`: outputs within a step are computed before the step, which may then fail. A
    /// run that has reached its end keeps all of them, even if its last step ends short of them by rounding.
    pub(crate) fn drop_outputs_beyond(&mut self, end: T, stepper: &Integration<T>) {
        let is_within = |&t: &T| !stepper.direction.is_before(end, t);
        let within = self.output_times.partition_point(is_within);
        self.output_times.truncate(within);
        self.outputs.truncate(2 * self.m * within);
    }

    pub(crate) fn fail(
        mut self,
        error: IntegrateError<T>,
        stepper: &Integration<T>,
    ) -> RunFailure<T> {
        let end = self.ended.unwrap_or(stepper.time);
        if self.times.last() != Some(&end) {
            self.keep(&stepper.view());
        }
        self.drop_outputs_beyond(end, stepper);
        self.stopped = false;
        self.finish(stepper);
        RunFailure {
            error,
            partial: Some(Box::new(self)),
        }
    }

    /// The number of stored states, including the initial one.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// A run always stores its initial state.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// The times of the stored states.
    pub fn times(&self) -> &[T] {
        &self.times
    }

    /// The positions of state number `i`, length m.
    pub fn q(&self, i: usize) -> &[T] {
        &self.states[2 * self.m * i..][..self.m]
    }

    /// The momenta of state number `i`, length m.
    pub fn p(&self, i: usize) -> &[T] {
        &self.states[2 * self.m * i + self.m..][..self.m]
    }

    /// The last state: time, positions, momenta.
    pub fn last(&self) -> (T, &[T], &[T]) {
        let i = self.len() - 1;
        (self.times[i], self.q(i), self.p(i))
    }

    /// H − H_ref of the stored states; empty if the energy was not measured.
    pub fn energy_errors(&self) -> &[T] {
        &self.energy_errors
    }

    /// The outcomes of the steps that led to the stored states. The entry of the initial state is
    /// meaningless.
    pub fn outcomes(&self) -> &[Outcome] {
        &self.outcomes
    }

    /// The states at the times requested with [`Integrator::output_at`](crate::Integrator::output_at): time,
    /// positions, momenta.
    pub fn outputs(&self) -> impl Iterator<Item = (T, &[T], &[T])> {
        self.output_times
            .iter()
            .zip(self.outputs.chunks_exact(2 * self.m))
            .map(|(&t, y)| {
                let (q, p) = y.split_at(self.m);
                (t, q, p)
            })
    }

    /// The trajectory, if dense output was requested.
    pub fn trajectory(&self) -> Option<&Trajectory<T>> {
        self.trajectory.as_ref()
    }

    /// The roots of the event functions, in the order of the run.
    pub fn events(&self) -> &[Occurrence<T>] {
        &self.occurrences
    }

    /// Whether an observer or a terminal event ended the run before the end of the interval.
    pub fn stopped(&self) -> bool {
        self.stopped
    }

    /// The certificate of the run.
    pub fn certificate(&self) -> &Certificate<T> {
        &self.certificate
    }
}
