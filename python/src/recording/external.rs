//! [`external`]: an energy whose value and gradient are functions of Python.

use crate::faults::value_error;
use crate::number::Doubles;
use equip::prelude::Hamiltonian;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// The first exception that a function of Python has raised while it was called for numbers.
#[derive(Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
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
/// Where one of them raises an exception its numbers are NaN, and the exception is kept in `raised`.
pub(crate) fn external(
    m: usize,
    accuracy: f64,
    value: Py<PyAny>,
    gradient: Py<PyAny>,
    raised: &Raised,
) -> PyResult<Hamiltonian> {
    let (of_value, of_gradient) = (raised.clone(), raised.clone());
    let value = move |q: &[f64], p: &[f64]| {
        let found = Python::try_attach(|py| {
            let found = value.bind(py).call1(arrays(py, q, p))?;
            found.extract::<f64>()
        });
        numbers(found, &of_value).unwrap_or(f64::NAN)
    };
    let gradient = move |q: &[f64], p: &[f64], dq: &mut [f64], dp: &mut [f64]| {
        let found = Python::try_attach(|py| {
            let found = gradient.bind(py).call1(arrays(py, q, p))?;
            let found = found.extract::<PyReadonlyArray1<'_, f64>>()?;
            let (of_q, of_p) = found.as_slice()?.split_at(m);
            dq.copy_from_slice(of_q);
            dp.copy_from_slice(of_p);
            Ok(())
        });
        if numbers(found, &of_gradient).is_none() {
            dq.fill(f64::NAN);
            dp.fill(f64::NAN);
        }
    };
    Hamiltonian::external(m, accuracy, value, gradient).map_err(value_error)
}

fn arrays<'py>(py: Python<'py>, q: &[f64], p: &[f64]) -> (Doubles<'py>, Doubles<'py>) {
    (PyArray1::from_slice(py, q), PyArray1::from_slice(py, p))
}

/// What was found; nothing where an exception was raised, or where Python has ended.
fn numbers<R>(found: Option<PyResult<R>>, raised: &Raised) -> Option<R> {
    match found? {
        Ok(found) => Some(found),
        Err(error) => {
            raised.keep(error);
            None
        }
    }
}
