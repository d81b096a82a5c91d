//! Errors of the library as exceptions of Python.

use equip::prelude::IntegrateError;
use equip::scalar::Float;
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    equip,
    IntegrationError,
    PyRuntimeError,
    "A step could not be made. The text says what to change."
);

/// Input that cannot be used.
pub(crate) fn value_error(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// What a run or a step ended with: bad input is a `ValueError`, a fault on the way an `IntegrationError`.
pub(crate) fn of_run<T: Float>(error: &IntegrateError<T>) -> PyErr {
    match error {
        IntegrateError::EventTooRough { .. }
        | IntegrateError::TargetBelowRoundOff { .. }
        | IntegrateError::TargetNotReached { .. }
        | IntegrateError::StepRuleNotMet { .. }
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
