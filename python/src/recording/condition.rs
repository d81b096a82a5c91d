//! [`Condition`]: a comparison of variables, by which `np.where` chooses.

use crate::recording::variable::{COMPARED, Variable, called_by_numpy, number};
use equip::prelude::Var;
use pyo3::basic::CompareOp;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

const ALTERNATIVES: &str =
    "np.where chooses between numbers and variables of H: collect others with np.stack";

/// A comparison of variables of H, while it is recorded: for np.where. It is neither true nor false.
#[pyclass(frozen, name = "Condition", module = "equip")]
#[derive(Clone, Copy)]
pub(crate) struct Condition {
    test: Variable,
    /// It holds where `test` is less than 0, else where it is not.
    is_where_negative: bool,
}

impl Condition {
    pub(crate) fn new(test: Variable, is_where_negative: bool) -> Self {
        Condition {
            test,
            is_where_negative,
        }
    }

    fn select(&self, a: Var, b: Var) -> PyResult<Variable> {
        let (at_least_zero, below) = if self.is_where_negative {
            (b, a)
        } else {
            (a, b)
        };
        self.test.map(|test| test.select(at_least_zero, below))
    }

    /// 1 where it holds, else −1.
    fn sign(&self) -> PyResult<Variable> {
        self.select(Var::from(1.0), Var::from(-1.0))
    }

    fn with(
        &self,
        other: &Bound<'_, PyAny>,
        f: impl FnOnce(Var, Var) -> Var,
    ) -> PyResult<Py<PyAny>> {
        let py = other.py();
        let other = match (other.cast::<Condition>(), other.extract::<bool>()) {
            (Ok(other), _) => other.get().sign()?.here()?,
            (_, Ok(other)) => Var::from(if other { 1.0 } else { -1.0 }),
            _ => return Ok(py.NotImplemented()),
        };
        let both = self.sign()?.map(|x| f(x, other))?;
        Ok(Py::new(py, Condition::new(both, false))?.into_any())
    }
}

#[pymethods]
impl Condition {
    /// `a` where it holds, else `b`.
    fn choose(&self, a: &Bound<'_, PyAny>, b: &Bound<'_, PyAny>) -> PyResult<Variable> {
        match (number(a)?, number(b)?) {
            (Some(a), Some(b)) => self.select(a, b),
            _ => Err(PyTypeError::new_err(ALTERNATIVES)),
        }
    }
    fn __and__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x.min(y))
    }
    fn __rand__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x.min(y))
    }
    fn __or__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x.max(y))
    }
    fn __ror__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x.max(y))
    }
    /// A mask: the other factor where it holds, else 0.
    fn __mul__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        match number(other)? {
            Some(x) => Ok(Py::new(other.py(), self.select(x, Var::from(0.0))?)?.into_any()),
            None => Ok(other.py().NotImplemented()),
        }
    }
    fn __rmul__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.__mul__(other)
    }
    fn __invert__(&self) -> Self {
        Condition::new(self.test, !self.is_where_negative)
    }
    fn __bool__(&self) -> PyResult<bool> {
        Err(PyTypeError::new_err(COMPARED))
    }
    fn __repr__(&self) -> &'static str {
        "<condition of H>"
    }
}

called_by_numpy!(Condition);

#[pymethods]
impl Variable {
    /// A condition, for `np.where`; equality holds almost nowhere.
    fn __richcmp__(&self, other: &Bound<'_, PyAny>, op: CompareOp) -> PyResult<Py<PyAny>> {
        let py = other.py();
        if matches!(op, CompareOp::Eq | CompareOp::Ne) {
            return Err(PyTypeError::new_err(COMPARED));
        }
        let x = self.here()?;
        let Some(y) = number(other)? else {
            return Ok(py.NotImplemented());
        };
        let (test, is_where_negative) = match op {
            CompareOp::Ge => (x - y, false),
            CompareOp::Lt => (x - y, true),
            CompareOp::Le => (y - x, false),
            _ => (y - x, true),
        };
        let condition = Condition::new(self.of(test), is_where_negative);
        Ok(Py::new(py, condition)?.into_any())
    }
}
