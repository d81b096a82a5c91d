//! [`Recorded`]: a function of (q, p) recorded from a Python callable, or that of a scene.

use crate::faults::value_error;
use crate::recording::constant::constant;
use crate::recording::variable::{Begun, Variable};
use equip::autodiff::{Evaluate, RecordedEvaluator};
use equip::prelude::{Hamiltonian, System, Var};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

type Doubles<'py> = Bound<'py, PyArray1<f64>>;

/// A function of y = (q, p), 2m numbers, or of (t, q, p), whose values are read at y = (q, t, p, 0).
#[pyclass(frozen, module = "equip._native")]
pub(crate) struct Recorded {
    pub(crate) hamiltonian: Hamiltonian,
    evaluator: Mutex<Option<RecordedEvaluator<f64>>>,
}

impl From<Hamiltonian> for Recorded {
    fn from(hamiltonian: Hamiltonian) -> Self {
        Recorded {
            hamiltonian,
            evaluator: Mutex::new(None),
        }
    }
}

impl Recorded {
    /// Numbers of a state at which values are read.
    fn width(&self) -> usize {
        2 * self.hamiltonian.degrees_of_freedom()
    }

    /// Values for each of the states in `y`, one after the other, `width` numbers each.
    fn each<'py>(
        &self,
        y: &PyReadonlyArray1<'py, f64>,
        width: usize,
        f: impl Fn(&mut RecordedEvaluator<f64>, &[f64], &mut [f64]),
    ) -> PyResult<Doubles<'py>> {
        let py = y.py();
        let y = y.as_slice()?;
        let n = self.width();
        let mut results = vec![0.0; y.len() / n * width];
        let mut held = self
            .evaluator
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let evaluator = held.get_or_insert_with(|| self.hamiltonian.alone().evaluator());
        let states = y.chunks_exact(n).zip(results.chunks_exact_mut(width));
        states.for_each(|(y, result)| f(evaluator, y, result));
        Ok(results.into_pyarray(py))
    }
}

#[pymethods]
impl Recorded {
    /// Calls `function(q, p)` once, with lists of m variables, and keeps its formula.
    #[new]
    fn new(function: &Bound<'_, PyAny>, m: usize) -> PyResult<Self> {
        let fault = RefCell::new(None);
        let made = Hamiltonian::new(m, |q, p| {
            call(function, None, q, p).unwrap_or_else(|error| {
                fault.replace(Some(error));
                q[0]
            })
        });
        match fault.into_inner() {
            Some(error) => Err(error),
            None => made.map(Recorded::from).map_err(value_error),
        }
    }

    /// Calls `function(t, q, p)` twice, with a variable and lists of m variables, and keeps its formula.
    #[staticmethod]
    fn with_time(function: &Bound<'_, PyAny>, m: usize) -> PyResult<Self> {
        let fault = RefCell::new(None);
        let made = Hamiltonian::with_time(m, |t, q, p| {
            if fault.borrow().is_some() {
                return t;
            }
            call(function, Some(t), q, p).unwrap_or_else(|error| {
                fault.replace(Some(error));
                t
            })
        });
        match fault.into_inner() {
            Some(error) => Err(error),
            None => made.map(Recorded::from).map_err(value_error),
        }
    }

    /// The recording as bytes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.hamiltonian.to_bytes().map_err(value_error)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The function of which `to_bytes` made the bytes.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let table = |bytes: &[u8]| equip::tables::from_bytes(bytes).ok();
        let found = Hamiltonian::from_bytes_with(bytes, table).map_err(value_error)?;
        Ok(Recorded::from(found))
    }

    /// Those of the user: time is none.
    #[getter]
    fn degrees_of_freedom(&self) -> usize {
        self.hamiltonian.degrees_of_freedom() - usize::from(self.has_time())
    }

    #[getter]
    fn has_time(&self) -> bool {
        self.hamiltonian.has_time()
    }

    #[getter]
    fn separable(&self) -> bool {
        self.hamiltonian.structure().separable
    }

    #[getter]
    fn degree(&self) -> Option<u32> {
        self.hamiltonian.alone().structure().degree
    }

    #[getter]
    fn operations(&self) -> usize {
        self.hamiltonian.alone().operations()
    }

    #[getter]
    fn gradient_operations(&self) -> usize {
        self.hamiltonian.gradient_operations()
    }

    /// H of each state.
    fn values<'py>(&self, y: PyReadonlyArray1<'py, f64>) -> PyResult<Doubles<'py>> {
        self.each(&y, 1, |evaluator, y, result| result[0] = evaluator.value(y))
    }

    /// The components of ∇H of each state.
    fn gradients<'py>(&self, y: PyReadonlyArray1<'py, f64>) -> PyResult<Doubles<'py>> {
        self.each(&y, self.width(), |evaluator, y, result| {
            evaluator.gradient(y, result);
        })
    }

    /// The entries of ∇²H of each state, rows one after the other.
    fn hessians<'py>(&self, y: PyReadonlyArray1<'py, f64>) -> PyResult<Doubles<'py>> {
        let n = self.width();
        let alone = self.hamiltonian.alone();
        let pattern = &alone.structure().hessian;
        self.each(&y, n * n, |evaluator, y, result| {
            let mut entries = vec![0.0; pattern.len()];
            evaluator.hessian(y, &mut entries);
            for (i, row) in result.chunks_exact_mut(n).enumerate() {
                pattern.row(i).for_each(|(k, j)| row[j] = entries[k]);
            }
        })
    }
}

/// What `function` makes of variables: f(q, p), or f(t, q, p).
fn call(function: &Bound<'_, PyAny>, time: Option<Var>, q: &[Var], p: &[Var]) -> PyResult<Var> {
    static LAST: AtomicU64 = AtomicU64::new(0);
    let recording = LAST.fetch_add(1, Ordering::Relaxed) + 1;
    let _begun = Begun::new(recording);
    let variables = |all: &[Var]| -> Vec<Variable> {
        all.iter().map(|&var| Variable { var, recording }).collect()
    };
    let (q, p) = (variables(q), variables(p));
    let (found, name) = match time {
        None => (function.call1((q, p))?, "H(q, p)"),
        Some(var) => {
            let t = Variable { var, recording };
            (function.call1((t, q, p))?, "H(t, q, p)")
        }
    };
    if let Ok(found) = found.cast::<Variable>() {
        return found.get().here();
    }
    match constant(&found)? {
        Some(c) => Ok(Var::from(c)),
        None => Err(PyTypeError::new_err(format!(
            "{name} must return one number made of q and p; it returned {}",
            found.get_type().name()?
        ))),
    }
}
