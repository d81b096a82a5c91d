//! Errors of the library as exceptions of Python.

use equip::integrate::IntegrateError;
use equip::scalar::Float;
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::io;
use std::path::Path;

create_exception!(
    equip,
    IntegrationError,
    PyRuntimeError,
    "A step failed. The message says what to change."
);

create_exception!(
    equip,
    FileFormatError,
    PyValueError,
    "A file is damaged, or was not written by this version of equip."
);

create_exception!(
    equip,
    FileInUseError,
    PyRuntimeError,
    "Another process is writing the file."
);

/// A file that cannot be read or written, with the number that the system gave.
pub(crate) fn os_error(what: &str, path: &Path, error: &io::Error) -> PyErr {
    let text = format!("{what} {}: {error}", path.display());
    match error.raw_os_error() {
        Some(number) => PyOSError::new_err((number, text)),
        None => PyOSError::new_err(text),
    }
}

/// Input that cannot be used.
pub(crate) fn value_error(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// What a run or a step ended with: bad input is a `ValueError`, a fault on the way an `IntegrationError`.
pub(crate) fn of_run<T: Float>(error: IntegrateError<T>) -> PyErr {
    match error {
        IntegrateError::EventTooRough { .. }
        | IntegrateError::ChangedState { .. }
        | IntegrateError::TargetBelowRoundOff { .. }
        | IntegrateError::TargetNotReached { .. }
        | IntegrateError::StepBelowMinimum { .. }
        | IntegrateError::StepLimit { .. }
        | IntegrateError::NotFinite { .. }
        | IntegrateError::NoConvergence { .. }
        | IntegrateError::Astray { .. }
        | IntegrateError::Escape { .. }
        | IntegrateError::OutsideOfTable { .. }
        | IntegrateError::Singular { .. }
        | IntegrateError::NoAdmissibleAlpha { .. } => IntegrationError::new_err(error.to_string()),
        _ => value_error(error),
    }
}
