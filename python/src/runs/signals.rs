//! [`Signals`]: the observer of a run that another thread watches.

use crate::runs::keeping::Keeping;
use crate::runs::patience::{Meanwhile, PATIENCE, Stop};
use equip::integrate::{Observer, StepView};
use equip::prelude::Checkpoint;
use equip::scalar::Float;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// How often progress is shown.
const SHOWN: Duration = Duration::from_millis(50);

/// The time that a run has reached, as bits.
#[derive(Clone, Default)]
pub(crate) struct Reached(Arc<AtomicU64>);

/// Ends a run that is no longer wanted, tells its time, and writes its checkpoints.
pub(crate) struct Signals {
    stop: Stop,
    reached: Reached,
    keeping: Option<Keeping>,
    is_due: bool,
    pub(crate) fault: Option<PyErr>,
}

impl Signals {
    pub(crate) fn new(stop: &Stop, reached: Reached, keeping: Option<Keeping>) -> Self {
        Signals {
            stop: stop.clone(),
            reached,
            keeping,
            is_due: false,
            fault: None,
        }
    }
}

impl<T: Float> Observer<T> for Signals {
    fn step(&mut self, view: &StepView<'_, T>) -> ControlFlow<()> {
        let time = view.time.to_f64();
        self.reached.0.store(time.to_bits(), Relaxed);
        let is_over = self.stop.is_set();
        // An interrupted run is written down as well.
        self.is_due = (self.keeping.as_ref()).is_some_and(|k| is_over || k.is_due(time));
        match is_over {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
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

/// Shows the progress of a run, and lets it write its checkpoint when it is interrupted.
pub(crate) struct Watch<'a> {
    pub(crate) reached: Reached,
    progress: Option<&'a Py<PyAny>>,
    has_checkpoint: bool,
    shown: Instant,
}

impl<'a> Watch<'a> {
    pub(crate) fn new(progress: Option<&'a Py<PyAny>>, has_checkpoint: bool) -> Self {
        Watch {
            reached: Reached::default(),
            progress,
            has_checkpoint,
            shown: Instant::now(),
        }
    }
}

impl Meanwhile for Watch<'_> {
    fn look(&mut self, py: Python<'_>) -> PyResult<()> {
        let Some(f) = self
            .progress
            .filter(|_| self.shown.elapsed() >= SHOWN - PATIENCE / 2)
        else {
            return Ok(());
        };
        self.shown = Instant::now();
        let bits = self.reached.0.load(Relaxed);
        match bits {
            0 => Ok(()),
            bits => f.call1(py, (f64::from_bits(bits),)).map(drop),
        }
    }

    fn waits(&self) -> bool {
        self.has_checkpoint
    }
}
