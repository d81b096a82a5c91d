//! [`patiently`]: native work in a thread of its own, while this one answers signals.
//!
//! Handlers of signals are called by the main thread of Python. It waits here without the GIL, and looks for
//! signals every [`PATIENCE`]: an exception, such as that of Ctrl-C, is returned at once. The work is told,
//! and ends where it next looks: after a step, or after the state it evaluates. Its result is dropped then.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::thread;
use std::time::Duration;

/// How often Python is asked for signals.
pub(crate) const PATIENCE: Duration = Duration::from_millis(25);

/// Stack of a thread that works: as much as a main thread has.
const STACK: usize = 8 << 20;

/// Whether work is still wanted.
#[derive(Clone, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    pub(crate) fn is_set(&self) -> bool {
        self.0.load(Relaxed)
    }

    pub(crate) fn set(&self) {
        self.0.store(true, Relaxed);
    }
}

/// What is done while work is under way.
pub(crate) trait Meanwhile {
    /// Called every [`PATIENCE`].
    fn look(&mut self, _py: Python<'_>) -> PyResult<()> {
        Ok(())
    }

    /// Whether an exception waits for the work to end, which writes down what it has.
    fn waits(&self) -> bool {
        false
    }
}

impl Meanwhile for () {}

/// The result of `work`, or the exception of a handler of signals.
pub(crate) fn patiently<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> R + Send + 'static,
) -> PyResult<R> {
    patiently_with(py, &mut (), work)
}

/// The result of `work`, which is made in this thread unless it may take longer than a signal may wait.
pub(crate) fn patiently_if<R: Send + 'static>(
    is_long: bool,
    py: Python<'_>,
    work: impl FnOnce() -> R + Send + 'static,
) -> PyResult<R> {
    match is_long {
        true => patiently(py, move |_| work()),
        false => Ok(work()),
    }
}

/// The same as [`patiently`], with something that is done meanwhile.
pub(crate) fn patiently_with<R: Send + 'static>(
    py: Python<'_>,
    meanwhile: &mut impl Meanwhile,
    work: impl FnOnce(&Stop) -> R + Send + 'static,
) -> PyResult<R> {
    py.check_signals()?;
    let stop = Stop::default();
    let (sender, receiver) = sync_channel(1);
    let told = stop.clone();
    let worker = thread::Builder::new().stack_size(STACK).spawn(move || {
        // Nobody waits any more once an exception has ended the call.
        let _ = sender.send(work(&told));
    });
    let worker = worker.map_err(|error| {
        PyRuntimeError::new_err(format!("no thread could be started for this call: {error}"))
    })?;
    let receiver = Mutex::new(receiver);
    let wait = || match receiver.lock() {
        Ok(receiver) => receiver.recv_timeout(PATIENCE),
        Err(_) => Err(RecvTimeoutError::Disconnected),
    };
    let mut raised = None;
    loop {
        match py.detach(wait) {
            Ok(result) => return raised.map_or(Ok(result), Err),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                // The work has panicked: as in a call without a thread that is an exception of Python.
                if let Err(panic) = worker.join() {
                    std::panic::resume_unwind(panic);
                }
                return Err(PyRuntimeError::new_err("a thread ended early"));
            }
        }
        let asked = py.check_signals().and_then(|()| match raised {
            None => meanwhile.look(py),
            Some(_) => Ok(()),
        });
        if let Err(error) = asked {
            stop.set();
            // Who interrupts twice does not want to wait.
            if raised.is_some() || !meanwhile.waits() {
                return Err(raised.unwrap_or(error));
            }
            raised = Some(error);
        }
    }
}

/// The lock of something that work under way may hold, also work that nobody waits for.
pub(crate) fn lock<'a, T: Send>(py: Python<'_>, held: &'a Mutex<T>) -> PyResult<MutexGuard<'a, T>> {
    loop {
        match held.try_lock() {
            Ok(guard) => return Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => return Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                py.check_signals()?;
                py.detach(|| thread::sleep(PATIENCE / 25));
            }
        }
    }
}
