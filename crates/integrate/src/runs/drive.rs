//! The loop of a whole run, the same for fixed and for variable steps: step → dense output and events → observer → keep.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::options::record::Record;
use crate::runs::dense_watch::DenseWatch;
use crate::runs::observer::Observer;
use crate::runs::outputs::Outputs;
use crate::runs::run::{Run, RunFailure};
use crate::steppers::stepper::Stepper;
use crate::steppers::view::StepView;
use crate::tangent::chaos::Chaos;
use equip_autodiff::Evaluate;
use equip_scalar::Float;
use std::ops::ControlFlow;

/// The steps of a run up to its end.
pub(crate) trait Schedule<T: Float, E> {
    /// The state of the run.
    fn stepper(&self) -> &Stepper<T, E>;
    /// What rounding lost of the time.
    fn time_low(&self) -> T;
    /// Whether the end is reached.
    fn is_done(&self) -> bool;
    /// The run as it is now.
    fn checkpoint(&mut self) -> Checkpoint;
    /// Makes the next step.
    fn advance(&mut self) -> Result<(), IntegrateError<T>>;
}

/// What watches a run.
#[derive(Debug)]
pub(crate) struct Watchers<'a, T: Float, E> {
    pub(crate) record: Record,
    /// Output by extra steps: fixed steps only, with the time of the next grid point.
    pub(crate) outputs: Option<Outputs<'a, T, E>>,
    pub(crate) dense: Option<DenseWatch<T, E>>,
    pub(crate) chaos: Option<Chaos<T, E>>,
}

/// Makes the run.
pub(crate) fn drive<T: Float, E: Evaluate<T>>(
    steps: &mut impl Schedule<T, E>,
    mut watchers: Watchers<'_, T, E>,
    observer: &mut impl Observer<T>,
) -> Result<Run<T>, RunFailure<T>> {
    let mut run = Run::new(steps.stepper());
    match watch(steps, &mut watchers, observer, &mut run) {
        Ok(()) => {
            if let Some(dense) = watchers.dense {
                dense.finish(&mut run);
            }
            run.finish(steps.stepper());
            Ok(run)
        }
        Err(error) => {
            if let Some(dense) = watchers.dense {
                dense.finish(&mut run);
            }
            Err(run.fail(error, steps.stepper()))
        }
    }
}

fn watch<T: Float, E: Evaluate<T>>(
    steps: &mut impl Schedule<T, E>,
    watchers: &mut Watchers<'_, T, E>,
    observer: &mut impl Observer<T>,
    run: &mut Run<T>,
) -> Result<(), IntegrateError<T>> {
    while !steps.is_done() {
        if let Some(outputs) = &mut watchers.outputs {
            outputs.up_to(steps.stepper(), false, run)?;
        }
        let time_low = steps.time_low();
        steps.advance()?;
        let stepper = steps.stepper();
        if let Some(chaos) = &mut watchers.chaos {
            chaos.see(stepper)?;
            run.certificate.chaos = Some(chaos.indicators());
        }
        if let Some(dense) = &mut watchers.dense
            && let ControlFlow::Break((time, y)) = dense.see(stepper, time_low, run)?
        {
            run.end_at(time, y, stepper);
            return Ok(());
        }
        let view = StepView {
            chaos: run.certificate.chaos,
            ..stepper.view()
        };
        let mut stop = observer.step(&view) == ControlFlow::Break(());
        if observer.wants_checkpoint() {
            let mut checkpoint = steps.checkpoint();
            checkpoint.chaos = watchers.chaos.as_ref().map(Chaos::memory);
            stop |= observer.checkpoint(checkpoint) == ControlFlow::Break(());
        }
        let view = steps.stepper().view();
        if stop || steps.is_done() || watchers.record.keeps(view.index) {
            run.keep(&view);
        }
        if stop {
            run.stop();
            return Ok(());
        }
    }
    let stepper = steps.stepper();
    if let Some(outputs) = &mut watchers.outputs {
        outputs.up_to(stepper, true, run)?;
    }
    if let Some(dense) = &mut watchers.dense {
        dense.last_outputs(stepper, run);
    }
    Ok(())
}
