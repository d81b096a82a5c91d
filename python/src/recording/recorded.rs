//! [`Recorded`]: a function of (q, p) recorded from a Python callable, that of a scene, or an external one.

use crate::faults::value_error;
use crate::number::Doubles;
use crate::recording::external::{Raised, external, external_potential};
use crate::recording::variable::{self, Begun, Variable};
use crate::runs::patience::{Stop, lock, patiently, patiently_if};
use equip::autodiff::{BuildError, Formula};
use equip::prelude::{Hamiltonian, Var};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

type Evaluator = equip::autodiff::Evaluator<f64>;

/// Operations and positions of an H of which all is made ready, and evaluated once, within some
/// milliseconds: 60 operations of ∇²H for each one of H, a microsecond for a hundred of them.
const SMALL: usize = 500;
const FEW: usize = 16;

/// Evaluations of a small H that are made without a look at signals, in operations: some milliseconds.
const SHORT: usize = 1 << 20;

/// A function of y = (q, p), 2m numbers, or of (t, q, p), whose values are read at y = (q, t, p, 0).
#[pyclass(frozen, module = "equip._native")]
pub(crate) struct Recorded {
    pub(crate) hamiltonian: Hamiltonian,
    /// Operations as recorded.
    length: usize,
    evaluator: Arc<Mutex<Option<Evaluator>>>,
    /// What its functions have raised, if it calls Python.
    pub(crate) raised: Raised,
}

impl Recorded {
    pub(crate) fn new(hamiltonian: Hamiltonian, length: usize) -> Self {
        Recorded {
            hamiltonian,
            length,
            evaluator: Arc::default(),
            raised: Raised::default(),
        }
    }

    /// Whether what is derived of H may take longer than a signal may wait.
    pub(crate) fn is_large(&self) -> bool {
        self.length > SMALL || self.hamiltonian.degrees_of_freedom() > FEW
    }

    /// Numbers of a state at which values are read.
    fn width(&self) -> usize {
        2 * self.hamiltonian.degrees_of_freedom()
    }

    /// Something that is derived of H.
    fn derive<R: Send + 'static>(
        &self,
        py: Python<'_>,
        f: impl FnOnce(&Hamiltonian) -> R + Send + 'static,
    ) -> PyResult<R> {
        let hamiltonian = self.hamiltonian.clone();
        let work = move || f(&hamiltonian);
        self.raised.or(|| patiently_if(self.is_large(), py, work))
    }

    /// Values for each of the states in `y`, one after the other, `width` numbers each.
    fn each<'py>(
        &self,
        y: &PyReadonlyArray1<'py, f64>,
        width: usize,
        f: impl Fn(&mut Evaluator, &[f64], &mut [f64]) + Send + 'static,
    ) -> PyResult<Doubles<'py>> {
        let (py, y, n) = (y.py(), y.as_slice()?, self.width());
        let states = y.len() / n;
        let evaluate =
            move |held: &mut Option<Evaluator>, h: &Hamiltonian, y: &[f64], stop: &Stop| {
                let mut results = vec![0.0; y.len() / n * width];
                let evaluator = held.get_or_insert_with(|| h.alone().evaluator());
                let states = y.chunks_exact(n).zip(results.chunks_exact_mut(width));
                for (y, result) in states {
                    if stop.is_set() {
                        break;
                    }
                    f(evaluator, y, result);
                }
                results
            };
        let is_short = states.saturating_mul(width).saturating_mul(self.length) <= SHORT;
        let values = self.raised.or(|| {
            if is_short && !self.is_large() {
                let mut held = lock(py, &self.evaluator)?;
                return Ok(evaluate(&mut held, &self.hamiltonian, y, &Stop::default()));
            }
            // The lock is taken there: it may be held by work that nobody waits for any more.
            let (y, h) = (y.to_vec(), self.hamiltonian.clone());
            let held = Arc::clone(&self.evaluator);
            patiently(py, move |stop| {
                let mut held = held.lock().unwrap_or_else(PoisonError::into_inner);
                evaluate(&mut held, &h, &y, stop)
            })
        })?;
        Ok(values.into_pyarray(py))
    }
}

#[pymethods]
impl Recorded {
    /// Calls `function(q, p)` once, with lists of m variables, and keeps its formula.
    #[new]
    fn record(function: &Bound<'_, PyAny>, m: usize) -> PyResult<Self> {
        let fault = RefCell::new(None);
        let made = Formula::new(m, |q, p| {
            call(function, None, q, p).unwrap_or_else(|error| {
                fault.replace(Some(error));
                q[0]
            })
        });
        finish(function.py(), fault, made)
    }

    /// Calls `function(t, q, p)` once, with a variable and lists of m variables, and keeps its formula.
    #[staticmethod]
    fn with_time(function: &Bound<'_, PyAny>, m: usize) -> PyResult<Self> {
        let fault = RefCell::new(None);
        let made = Formula::with_time(m, |t, q, p| {
            call(function, Some(t), q, p).unwrap_or_else(|error| {
                fault.replace(Some(error));
                t
            })
        });
        finish(function.py(), fault, made)
    }

    /// The system y' = B(y)∇H(y): `entries(q, p)` is called once with lists of m variables, and returns a
    /// list of (i, j, B_ij).
    fn with_bracket(&self, entries: &Bound<'_, PyAny>) -> PyResult<Self> {
        let (fault, m) = (RefCell::new(None), self.hamiltonian.degrees_of_freedom());
        let made = self.hamiltonian.clone().with_bracket(|y| {
            called_entries(entries, &y[..m], &y[m..]).unwrap_or_else(|error| {
                fault.replace(Some(error));
                Vec::new()
            })
        });
        match fault.into_inner() {
            Some(error) => Err(error),
            None => Ok(Recorded::new(made.map_err(value_error)?, self.length)),
        }
    }

    /// An energy of m positions that is not recorded: `value(q, p)` and `gradient(q, p)` are called for
    /// numbers.
    #[staticmethod]
    fn external(m: usize, accuracy: f64, value: Py<PyAny>, gradient: Py<PyAny>) -> PyResult<Self> {
        let raised = Raised::default();
        let hamiltonian = external(m, accuracy, value, gradient, &raised)?;
        Ok(Recorded {
            raised,
            ..Recorded::new(hamiltonian, SHORT)
        })
    }

    /// The same for a potential, and the masses of all components of q.
    #[staticmethod]
    fn external_potential(
        masses: PyReadonlyArray1<'_, f64>,
        accuracy: f64,
        value: Py<PyAny>,
        gradient: Py<PyAny>,
    ) -> PyResult<Self> {
        let raised = Raised::default();
        let masses = masses.as_slice()?;
        let hamiltonian = external_potential(masses, accuracy, value, gradient, &raised)?;
        Ok(Recorded {
            raised,
            ..Recorded::new(hamiltonian, SHORT)
        })
    }

    /// The recording as bytes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.derive(py, Hamiltonian::to_bytes)?;
        Ok(PyBytes::new(py, &bytes.map_err(value_error)?))
    }

    /// The function of `m` positions of which `to_bytes` made the bytes.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let (length, bytes) = (bytes.len(), bytes.to_vec());
        let found = patiently_if(length > SMALL, py, move || {
            let table = |bytes: &[u8]| equip::tables::from_bytes(bytes).ok();
            Hamiltonian::from_bytes_with(&bytes, table)
        });
        Ok(Recorded::new(found?.map_err(value_error)?, length))
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
    fn is_canonical(&self) -> bool {
        self.hamiltonian.is_canonical()
    }

    #[getter]
    fn separable(&self) -> bool {
        self.hamiltonian.structure().separable
    }

    #[getter]
    fn degree(&self, py: Python<'_>) -> PyResult<Option<u32>> {
        self.derive(py, |h| h.alone().structure().degree)
    }

    #[getter]
    fn operations(&self, py: Python<'_>) -> PyResult<usize> {
        self.derive(py, |h| h.alone().operations())
    }

    #[getter]
    fn gradient_operations(&self, py: Python<'_>) -> PyResult<usize> {
        self.derive(py, Hamiltonian::gradient_operations)
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
        let (n, h) = (self.width(), self.hamiltonian.alone());
        self.each(&y, n * n, move |evaluator, y, result| {
            let pattern = &h.structure().hessian;
            let mut entries = vec![0.0; pattern.len()];
            evaluator.hessian(y, &mut entries);
            for (i, row) in result.chunks_exact_mut(n).enumerate() {
                pattern.row(i).for_each(|(k, j)| row[j] = entries[k]);
            }
        })
    }
}

/// The energy of a formula, if nothing was raised while it was recorded.
fn finish(
    py: Python<'_>,
    fault: RefCell<Option<PyErr>>,
    made: Result<Formula, BuildError>,
) -> PyResult<Recorded> {
    if let Some(error) = fault.into_inner() {
        return Err(error);
    }
    let formula = made.map_err(value_error)?;
    let length = formula.len();
    let hamiltonian = patiently_if(length > SMALL, py, move || formula.hamiltonian())?;
    Ok(Recorded::new(hamiltonian.map_err(value_error)?, length))
}

/// What `function` makes of variables: f(q, p), or f(t, q, p).
fn call(function: &Bound<'_, PyAny>, time: Option<Var>, q: &[Var], p: &[Var]) -> PyResult<Var> {
    let recording = next_recording();
    let _begun = Begun::new(recording);
    let (q, p) = (variables(q, recording), variables(p, recording));
    let (found, name) = match time {
        None => (function.call1((q, p))?, "H(q, p)"),
        Some(var) => {
            let t = Variable { var, recording };
            (function.call1((t, q, p))?, "H(t, q, p)")
        }
    };
    number(&found, name)
}

/// The entries (i, j, B_ij) that `function` makes of variables.
fn called_entries(
    function: &Bound<'_, PyAny>,
    q: &[Var],
    p: &[Var],
) -> PyResult<Vec<(usize, usize, Var)>> {
    let recording = next_recording();
    let _begun = Begun::new(recording);
    let found = function.call1((variables(q, recording), variables(p, recording)))?;
    let entries: Vec<(usize, usize, Bound<'_, PyAny>)> = found.extract()?;
    let numbers = entries
        .iter()
        .map(|(i, j, entry)| Ok((*i, *j, number(entry, "an entry of the bracket")?)));
    numbers.collect()
}

fn next_recording() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

fn variables(all: &[Var], recording: u64) -> Vec<Variable> {
    all.iter().map(|&var| Variable { var, recording }).collect()
}

/// What a function called `name` has returned.
fn number(found: &Bound<'_, PyAny>, name: &str) -> PyResult<Var> {
    match variable::number(found)? {
        Some(found) => Ok(found),
        None => Err(PyTypeError::new_err(format!(
            "{name} must return one number made of q and p; it returned {}",
            found.get_type().name()?.to_cow()?
        ))),
    }
}
