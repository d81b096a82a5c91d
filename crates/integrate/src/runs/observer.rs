//! Observers: user code that sees every step and may end the run.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::steppers::view::StepView;
use std::ops::ControlFlow;

/// Sees every accepted step. Closures `|view: &StepView<T>| -> ControlFlow<()>` are observers.
pub trait Observer<T> {
    /// Called after every step. `ControlFlow::Break(())` ends the run with the results so far.
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()>;

    /// Called after every step: whether a checkpoint is wanted now. Never, by default.
    fn wants_checkpoint(&mut self) -> bool {
        false
    }

    /// Receives the checkpoint. `ControlFlow::Break(())` ends the run.
    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        let _ = checkpoint;
        ControlFlow::Continue(())
    }
}

impl<T, F: FnMut(&StepView<'_, T>) -> ControlFlow<()>> Observer<T> for F {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        self(view)
    }
}

/// The observer that does nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoObserver;

impl<T> Observer<T> for NoObserver {
    fn step(&mut self, _: &StepView<'_, T>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
