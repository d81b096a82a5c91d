//! [`Signals`]: Ctrl-C, and progress, while the GIL is free.

use crate::runs::keeping::Keeping;
use equip::prelude::{Checkpoint, Observer, StepView};
use equip::scalar::Float;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// How often Python is asked for signals.
pub(crate) const PATIENCE: Duration = Duration::from_millis(50);

/// Steps between two readings of the clock, at most.
const STEPS: u32 = 64;

/// Asks Python for signals now and then, and tells it the time reached; an exception ends the run.
pub(crate) struct Signals<'a> {
    asked: Instant,
    left: u32,
    period: u32,
    progress: Option<&'a Py<PyAny>>,
    keeping: Option<Keeping>,
    is_due: bool,
    pub(crate) fault: Option<PyErr>,
}

impl<'a> Signals<'a> {
    pub(crate) fn new(progress: Option<&'a Py<PyAny>>, keeping: Option<Keeping>) -> Self {
        Signals {
            asked: Instant::now(),
            left: 1,
            period: 1,
            progress,
            keeping,
            is_due: false,
            fault: None,
        }
    }

    /// A step has been made that ends at `time`.
    pub(crate) fn step_to(&mut self, time: f64) -> ControlFlow<()> {
        self.left -= 1;
        if self.left > 0 {
            return ControlFlow::Continue(());
        }
        let elapsed = self.asked.elapsed();
        // Long steps are watched one by one, short ones up to 64 at a time.
        self.period = if elapsed < PATIENCE / 8 {
            (2 * self.period).min(STEPS)
        } else {
            (self.period / 2).max(1)
        };
        self.left = self.period;
        if elapsed < PATIENCE {
            return ControlFlow::Continue(());
        }
        self.asked = Instant::now();
        let asked = Python::attach(|py| {
            py.check_signals()?;
            self.progress
                .map_or(Ok(()), |f| f.call1(py, (time,)).map(drop))
        });
        match asked {
            Ok(()) => ControlFlow::Continue(()),
            Err(error) => {
                self.fault = Some(error);
                ControlFlow::Break(())
            }
        }
    }
}

impl<T: Float> Observer<T> for Signals<'_> {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        let time = view.time.to_f64();
        let flow = self.step_to(time);
        // An interrupted run is written down as well.
        self.is_due =
            (self.keeping.as_ref()).is_some_and(|keeping| flow.is_break() || keeping.is_due(time));
        flow
    }

    fn wants_checkpoint(&mut self) -> bool {
        self.is_due
    }

    fn checkpoint(&mut self, checkpoint: Checkpoint) -> ControlFlow<()> {
        let written = self.keeping.as_mut().map(|k| k.write(&checkpoint));
        match written {
            Some(Err(error)) => {
                self.fault.get_or_insert(error);
                ControlFlow::Break(())
            }
            _ => ControlFlow::Continue(()),
        }
    }
}
