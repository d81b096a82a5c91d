//! [`external`] and [`external_potential`]: energies whose value and gradient are functions of Python.

use crate::faults::value_error;
use equip::prelude::Hamiltonian;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::{Arc, Mutex, PoisonError};

/// The first exception that a function of Python has raised while it was called for numbers.
#[derive(Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    fn is_some(&self) -> bool {
        let first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.is_some()
    }

    fn keep(&self, error: PyErr) {
        let mut first = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(error);
    }

    /// The result of `work`, or the exception of Python, of which an error of the run is a consequence. An
    /// exception of an earlier call is forgotten.
    pub(crate) fn or<R>(&self, work: impl FnOnce() -> PyResult<R>) -> PyResult<R> {
        let take = || self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        take();
        let made = work();
        take().map_or(made, Err)
    }
}

/// The energy of `value(q, p)`, a number, and `gradient(q, p)`, an array of ∂H/∂q and ∂H/∂p, 2m numbers.
/// Where one of them raises an exception, its numbers and all later ones are NaN, which ends the run, and the
/// exception is kept in `raised`.
pub(crate) fn external(
    m: usize,
    accuracy: f64,
    value: Py<PyAny>,
    gradient: Py<PyAny>,
    raised: &Raised,
) -> PyResult<Hamiltonian> {
    let (of_value, of_gradient) = (raised.clone(), raised.clone());
    Hamiltonian::external(
        m,
        accuracy,
        move |q, p| number(&value, &[q, p], &of_value),
        move |q, p, dq, dp| array_into(&gradient, &[q, p], [dq, dp], &of_gradient),
    )
    .map_err(value_error)
}

/// The energy with these masses and the potential `value(q)`, a number, with `gradient(q)`, an array of m
/// numbers. Exceptions are handled as in [`external`].
pub(crate) fn external_potential(
    masses: &[f64],
    accuracy: f64,
    value: Py<PyAny>,
    gradient: Py<PyAny>,
    raised: &Raised,
) -> PyResult<Hamiltonian> {
    let (of_value, of_gradient) = (raised.clone(), raised.clone());
    Hamiltonian::external_potential(
        masses,
        accuracy,
        move |q| number(&value, &[q], &of_value),
        move |q, dq| array_into(&gradient, &[q], [dq], &of_gradient),
    )
    .map_err(value_error)
}

/// The number that `value` returns for these arrays.
fn number(value: &Py<PyAny>, arrays: &[&[f64]], raised: &Raised) -> f64 {
    let found = || Python::try_attach(|py| called(py, value, arrays)?.extract::<f64>());
    numbers(found, raised).unwrap_or(f64::NAN)
}

/// Writes the array that `gradient` returns for these arrays to `parts`, one after the other.
fn array_into<const N: usize>(
    gradient: &Py<PyAny>,
    arrays: &[&[f64]],
    mut parts: [&mut [f64]; N],
    raised: &Raised,
) {
    let found = || {
        Python::try_attach(|py| {
            let found = called(py, gradient, arrays)?;
            let found = found.extract::<PyReadonlyArray1<'_, f64>>()?;
            let mut rest = found.as_slice()?;
            for part in &mut parts {
                let (own, others) = rest.split_at(part.len());
                part.copy_from_slice(own);
                rest = others;
            }
            Ok(())
        })
    };
    if numbers(found, raised).is_none() {
        parts.iter_mut().for_each(|part| part.fill(f64::NAN));
    }
}

fn called<'py>(
    py: Python<'py>,
    function: &Py<PyAny>,
    arrays: &[&[f64]],
) -> PyResult<Bound<'py, PyAny>> {
    let arrays = arrays.iter().map(|array| PyArray1::from_slice(py, array));
    function.bind(py).call1(PyTuple::new(py, arrays)?)
}

/// What is found; nothing where an exception is or was raised, or where Python has ended.
fn numbers<R>(find: impl FnOnce() -> Option<PyResult<R>>, raised: &Raised) -> Option<R> {
    if raised.is_some() {
        return None;
    }
    match find()? {
        Ok(found) => Some(found),
        Err(error) => {
            raised.keep(error);
            None
        }
    }
}
