//! The loop of a complete run, the same for fixed and for variable steps: step → dense output and events →
//! observer → store.

use crate::checkpoints::memory::{Memory, Numbers};
use crate::error::IntegrateError;
use crate::events::watch::{CLOSEST, EventsAt};
use crate::options::record::Record;
use crate::runs::dense_watch::DenseWatch;
use crate::runs::observer::Observer;
use crate::runs::outputs::Outputs;
use crate::runs::run::{Run, RunFailure};
use crate::steppers::stepper::Stepper;
use crate::steppers::view::StepView;
use crate::tangent::chaos::Chaos;
use equip_scalar::Float;
use std::ops::ControlFlow;

/// The consumers of the steps of a run.
#[derive(Debug)]
pub(crate) struct Watchers<'a, T: Float> {
    pub(crate) record: Record,
    /// Output by extra steps.
    pub(crate) outputs: Option<Outputs<'a, T>>,
    pub(crate) dense: Option<DenseWatch<T>>,
    pub(crate) chaos: Option<Chaos<T>>,
}

/// Runs the loop.
pub(crate) fn drive<T: Float>(
    steps: &mut Stepper<T>,
    mut watchers: Watchers<'_, T>,
    observer: &mut dyn Observer<T>,
) -> Result<Run<T>, RunFailure<T>> {
    let mut run = Run::new(&steps.inner);
    let made = watch(steps, &mut watchers, observer, &mut run);
    if let Some(dense) = watchers.dense {
        dense.finish(&mut run);
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
    while !steps.is_done() {
        if let (Some(outputs), Some(end)) = (&mut watchers.outputs, steps.control.next_time()) {
            outputs.up_to(&steps.inner, Some(end), run);
        }
        let time_low = steps.control.time_low();
        let (before, occurred) = (steps.inner.before_leaving(), run.occurrences.len());
        steps.step()?;
        let stepper = &steps.inner;
        if let Some(outputs) = &mut watchers.outputs {
            outputs.within(stepper, run);
        }
        if let Some(chaos) = &mut watchers.chaos {
            chaos.see_step(stepper)?;
            run.certificate.chaos = Some(chaos.indicators());
        }
        let at = match &mut watchers.dense {
            Some(dense) => dense.see(stepper, time_low, run)?,
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
        if stop || steps.is_done() || watchers.record.keeps(view.index) {
            run.keep(&view);
        }
        if stop {
            run.stop();
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
