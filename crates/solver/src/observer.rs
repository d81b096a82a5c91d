//! Observers: code of the user's that sees every step and may end the run.

use crate::stepper::StepView;
use std::ops::ControlFlow;

/// Sees every accepted step. Closures `|view: &StepView<T>| -> ControlFlow<()>` are observers.
pub trait Observer<T> {
    /// Called after every step; `ControlFlow::Break(())` ends the run with what has been made so far.
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()>;
}

impl<T, F: FnMut(&StepView<'_, T>) -> ControlFlow<()>> Observer<T> for F {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        self(view)
    }
}

/// The observer that watches nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoObserver;

impl<T> Observer<T> for NoObserver {
    fn step(&mut self, _: &StepView<'_, T>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
