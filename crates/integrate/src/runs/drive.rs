//! The loop of a whole run, the same for fixed and for variable steps: step → dense output and events →
//! observer → keep.

use crate::error::IntegrateError;
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

/// Units of rounding of the time that two changes of the state have to be apart.
const CLOSEST: i64 = 256;

/// What watches a run.
#[derive(Debug)]
pub(crate) struct Watchers<'a, T: Float> {
    pub(crate) record: Record,
    /// Output by extra steps.
    pub(crate) outputs: Option<Outputs<'a, T>>,
    pub(crate) dense: Option<DenseWatch<T>>,
    pub(crate) chaos: Option<Chaos<T>>,
}

/// Makes the run.
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
        steps.step()?;
        let stepper = &steps.inner;
        if let Some(outputs) = &mut watchers.outputs {
            outputs.within(stepper, run);
        }
        if let Some(chaos) = &mut watchers.chaos {
            chaos.see_step(stepper)?;
            run.certificate.chaos = Some(chaos.indicators());
        }
        if let Some(dense) = &mut watchers.dense
            && let ControlFlow::Break((time, y)) = dense.see(stepper, time_low, run)?
        {
            let (mut state, m) = (y.to_vec(), y.len() / 2);
            let Some(action) = dense.action() else {
                run.end_at(time, &state, stepper);
                return Ok(());
            };
            let (q, p) = state.split_at_mut(m);
            if action(time, q, p) == ControlFlow::Break(()) {
                run.end_at(time, &state, stepper);
                return Ok(());
            }
            run.drop_outputs_beyond(time, stepper);
            kick(steps, watchers, (&state, time), run)?;
            // Events that accumulate, as of a ball that comes to rest, would be passed over unseen.
            let since = changed.replace(time).map(|before| (time - before).abs());
            let closest = T::int(CLOSEST) * T::EPSILON * time.abs();
            if let Some(step) = since.filter(|&since| since <= closest) {
                return Err(IntegrateError::StepBelowTimeResolution { step, time });
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
            checkpoint.chaos = watchers.chaos.as_ref().map(Chaos::memory);
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

/// Continues from the state that an event has made, at its time.
fn kick<T: Float>(
    steps: &mut Stepper<T>,
    watchers: &mut Watchers<'_, T>,
    (y, time): (&[T], T),
    run: &Run<T>,
) -> Result<(), IntegrateError<T>> {
    steps.kick(y.split_at(y.len() / 2), time)?;
    if let Some(dense) = &mut watchers.dense {
        dense.begin(time);
    }
    if let Some(outputs) = &mut watchers.outputs {
        outputs.rewind(run);
    }
    Ok(())
}
