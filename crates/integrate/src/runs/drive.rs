//! A complete run: its outputs, events and tangent vectors, and its loop, the same for fixed and for variable
//! steps: step → dense output and events → observer → store.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::memory::{Memory, Numbers};
use crate::error::IntegrateError;
use crate::events::watch::{CLOSEST, EventsAt};
use crate::options::common::Options;
use crate::options::event::Event;
use crate::options::integrator::Integrator;
use crate::options::record::Record;
use crate::runs::dense_watch::DenseWatch;
use crate::runs::observer::Observer;
use crate::runs::outputs::Outputs;
use crate::runs::run::{Run, RunFailure};
use crate::steppers::stepper::Stepper;
use crate::steppers::view::StepView;
use crate::tangent::{Chaos, any_tangent_vector};
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use std::ops::ControlFlow;

/// The consumers of the steps of a run.
#[derive(Debug)]
struct Watchers<'a, T: Float> {
    record: Record,
    /// Output by extra steps.
    outputs: Option<Outputs<'a, T>>,
    dense: Option<DenseWatch<T>>,
    chaos: Option<Chaos<T>>,
}

impl<T: Float> Integrator<T> {
    /// Continues the run of `stepper`, which has been started or resumed, to `end`.
    pub(crate) fn run(
        &self,
        system: &Hamiltonian,
        stepper: &mut Stepper<T>,
        (end, from): (T, Option<&Checkpoint>),
        observer: &mut dyn Observer<T>,
    ) -> Result<Run<T>, RunFailure<T>> {
        stepper.set_end(end)?;
        let inner = &mut stepper.inner;
        self.options.check_times(inner.stretch_start(), end)?;
        let (now, direction) = (inner.time, inner.direction);
        let times = &self.options.output_times;
        let times = &times[times.partition_point(|&t| direction.is_before(t, now))..];
        // If the time after the next step is known, outputs are computed by separate steps, which must not
        // affect the run.
        let by_steps = stepper.control.next_time().is_some();
        let outputs = match times {
            [] => None,
            _ if by_steps => Some(Outputs::new(inner.beside(self, system)?, times)),
            _ => None,
        };
        if let Some(domains) = &mut inner.domains {
            domains.may_end_before = self.options.events.iter().any(Event::acts);
        }
        let by_polynomial = if by_steps { &[] } else { times };
        if outputs.is_some() {
            inner.core.keep_parts();
        }
        let watchers = Watchers {
            record: self.options.record,
            outputs,
            dense: DenseWatch::new(system, &self.options, by_polynomial, inner)?,
            chaos: chaos_of_run(system, &self.options, stepper, from)?,
        };
        drive(stepper, watchers, observer)
    }
}

/// The tangent vector of a run with `options`, if requested, from its start or from the checkpoint `from`.
///
/// # Errors
/// The checkpoint has a tangent vector and the options have none, or vice versa.
fn chaos_of_run<T: Float>(
    system: &Hamiltonian,
    options: &Options<T>,
    run: &mut Stepper<T>,
    from: Option<&Checkpoint>,
) -> Result<Option<Chaos<T>>, IntegrateError<T>> {
    let follows = from.map_or(options.chaos, |from| from.chaos.is_some());
    if follows != options.chaos {
        let word = |follows| if follows { "followed" } else { "none followed" };
        return Err(IntegrateError::CheckpointMismatch {
            what: "tangent vector",
            stored: word(follows).to_owned(),
            now: word(options.chaos).to_owned(),
        });
    }
    if !options.chaos {
        return Ok(None);
    }
    let mut chaos = Chaos::new(system, run, &any_tangent_vector(2 * run.inner.m));
    if let Some(numbers) = from.and_then(|from| from.chaos.as_ref()) {
        let mut memory = Memory::to_read(numbers);
        chaos.remember(&mut memory);
        memory.check()?;
    }
    Ok(Some(chaos))
}

/// Runs the loop.
fn drive<T: Float>(
    steps: &mut Stepper<T>,
    mut watchers: Watchers<'_, T>,
    observer: &mut dyn Observer<T>,
) -> Result<Run<T>, RunFailure<T>> {
    let mut run = Run::new(&steps.inner);
    let made = watch(steps, &mut watchers, observer, &mut run);
    if let Some(dense) = watchers.dense {
        dense.finish(&steps.inner, &mut run);
    }
    match made {
        Ok(()) => {
            run.finish(&steps.inner);
            Ok(run)
        }
        Err(error) => Err(run.fail(error, &steps.inner)),
    }
}

fn watch<T: Float>(
    steps: &mut Stepper<T>,
    watchers: &mut Watchers<'_, T>,
    observer: &mut dyn Observer<T>,
    run: &mut Run<T>,
) -> Result<(), IntegrateError<T>> {
    let mut changed: Option<T> = None;
    while !steps.control.is_done(&steps.inner) {
        if let (Some(outputs), Some(end)) = (&mut watchers.outputs, steps.control.next_time()) {
            outputs.up_to(&steps.inner, Some(end), run);
        }
        let time_low = steps.control.time_low();
        let (before, occurred) = (steps.inner.before_leaving(), run.occurrences.len());
        steps.control.step(&mut steps.inner, true)?;
        let stepper = &steps.inner;
        if let Some(outputs) = &mut watchers.outputs {
            outputs.within(stepper, run);
        }
        if let Some(chaos) = &mut watchers.chaos {
            chaos.see(steps)?;
            run.certificate.chaos = Some(chaos.indicators());
        }
        let at = match &mut watchers.dense {
            Some(dense) => dense.see(&mut steps.inner, time_low, run)?,
            None => None,
        };
        if let Some((time, y)) = before
            && let Some(error) = steps.inner.has_left(at.as_ref().map(|at| (at.time, at.y)))
        {
            run.occurrences.truncate(occurred);
            run.end_at(time, &y, &steps.inner);
            return Err(error);
        }
        if let Some(at) = at {
            if act(at, steps, run, &mut changed)?.is_break() {
                return Ok(());
            }
            if let Some(outputs) = &mut watchers.outputs {
                outputs.rewind(run);
            }
        }
        let stepper = &steps.inner;
        let view = StepView {
            chaos: run.certificate.chaos,
            ..stepper.view()
        };
        let mut stop = observer.step(&view) == ControlFlow::Break(());
        if observer.wants_checkpoint() {
            let mut checkpoint = steps.checkpoint();
            if let Some(chaos) = &mut watchers.chaos {
                let numbers = checkpoint.chaos.insert(Numbers::new());
                chaos.remember(&mut Memory::to_write(numbers));
            }
            checkpoint.seal();
            stop |= observer.checkpoint(checkpoint) == ControlFlow::Break(());
        }
        let view = steps.view();
        if stop || steps.control.is_done(&steps.inner) || watchers.record.keeps(view.index) {
            run.keep(&view);
        }
        if stop {
            run.stopped = true;
            return Ok(());
        }
    }
    let stepper = &steps.inner;
    if let Some(outputs) = &mut watchers.outputs {
        outputs.up_to(stepper, None, run);
    }
    if let Some(dense) = &mut watchers.dense {
        dense.last_outputs(stepper, run);
    }
    Ok(())
}

/// Lets events end the run, or change its state, as they last `changed` it.
fn act<T: Float>(
    at: EventsAt<'_, T>,
    steps: &mut Stepper<T>,
    run: &mut Run<T>,
    changed: &mut Option<T>,
) -> Result<ControlFlow<()>, IntegrateError<T>> {
    let (time, before, event) = (at.time, at.y.to_vec(), at.events.changing());
    steps.inner.end_with(at.step);
    match steps.act(at) {
        Ok(ControlFlow::Continue(())) => run.drop_outputs_beyond(time, &steps.inner),
        Ok(ControlFlow::Break(state)) => {
            run.end_at(time, &state, &steps.inner);
            return Ok(ControlFlow::Break(()));
        }
        Err(error) => {
            run.end_at(time, &before, &steps.inner);
            return Err(error);
        }
    }
    let since = changed.replace(time).map(|before| (time - before).abs());
    let closest = T::int(CLOSEST) * T::EPSILON * time.abs();
    match since.filter(|&since| since <= closest) {
        Some(interval) => Err(IntegrateError::ChangedState {
            event,
            time,
            cause: format!(
                "its roots accumulate (the last change was {interval:e} earlier); end the run before that time, or at a root (`terminal`)"
            ),
        }),
        None => Ok(ControlFlow::Continue(())),
    }
}
