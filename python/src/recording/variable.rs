//! [`Variable`]: a component of q or p, or what is computed of them, while H(q, p) is recorded.

use crate::recording::condition::Condition;
use crate::recording::constant::constant;
use equip::prelude::{DoubleDouble, Var};
use equip::tables::floor;
use pyo3::basic::CompareOp;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::cell::{Cell, RefCell};

/// Operations between two looks at signals: NumPy makes all those of an array in one call, in which Python
/// itself does not look.
const OPERATIONS: u32 = 4096;

thread_local! {
    /// Numbers of the recordings under way, innermost last.
    static UNDER_WAY: RefCell<Vec<u64>> = const { RefCell::new(Vec::new()) };
    /// Operations recorded by this thread.
    static COUNT: Cell<u32> = const { Cell::new(0) };
}

/// Begins a recording of that number, until dropped.
pub(crate) struct Begun;

impl Begun {
    pub(crate) fn new(recording: u64) -> Self {
        UNDER_WAY.with_borrow_mut(|all| all.push(recording));
        Begun
    }
}

impl Drop for Begun {
    fn drop(&mut self) {
        UNDER_WAY.with_borrow_mut(Vec::pop);
    }
}

/// A component of q or p, or what is computed of them, while H(q, p) is recorded. It has no value.
#[pyclass(frozen, name = "Variable", module = "equip")]
#[derive(Clone, Copy)]
pub(crate) struct Variable {
    pub(crate) var: Var,
    pub(crate) recording: u64,
}

macro_rules! once {
    ($($text:literal)*) => {
        concat!($($text,)* ": H(q, p) is called once, before any state is known, to record its formula. ")
    };
}
pub(crate) const COMPARED: &str = concat!(
    once!("a variable of H cannot be compared"),
    "Use np.where on the condition, np.minimum, np.maximum, np.clip or abs() on q and p, on lists of variables \
     after np.stack (np.array makes an array that compares), or choose between two Hamiltonians outside H"
);
const TRUTH: &str = concat!(
    once!("a variable of H is neither true nor false"),
    "Use np.where, np.minimum, np.maximum, np.clip or abs() on q and p, or choose between two Hamiltonians \
     outside H"
);
const NUMBER: &str = concat!(
    once!("a variable of H is not a number"),
    "Use np.sin, np.sqrt, ... in place of math.sin, math.sqrt; leave out float() and int(); collect variables \
     with np.stack or in a list, not in an array of floats"
);
const MODULUS: &str =
    "pow(x, n, modulus) of a variable of H cannot be recorded: write x**n % modulus";
const BY_ZERO: &str =
    "a variable of H is divided by the constant 0; check the parameters captured by it";
const HASHED: &str = "a variable of H has no value, so that it cannot be a key of a dict or a member of a set. \
    Use lists, and the positions in them";
const FOREIGN: &str = "this variable belongs to another call of an H, or to another thread: make all of H from \
    its own q and p and from plain numbers";

/// Largest exponent that is taken as a whole number.
const MOST: f64 = 1e6;

/// Most decimals that a number is rounded to.
const MOST_DIGITS: i32 = 300;

/// ln 2, π/180 and 180/π.
const LN_2: &str = "0.693147180559945309417232121458176568075500134360255254120680";
const DEGREE: &str = "0.0174532925199432957692369076848861271344287188854172545609719144";
const RADIAN: &str = "57.2957795130823208767981548141051703324054724665643215491602438";

fn known(text: &'static str) -> Var {
    // All three are decimals.
    equip::scalar::decimal(text).map_or(Var::from(f64::NAN), Var::from)
}

impl Variable {
    /// The variable, if it is of the recording under way.
    pub(crate) fn here(&self) -> PyResult<Var> {
        let count = COUNT.get().wrapping_add(1);
        COUNT.set(count);
        if count.is_multiple_of(OPERATIONS) {
            Python::attach(|py| py.check_signals())?;
        }
        let now = UNDER_WAY.with_borrow(|all| all.last().copied());
        if now == Some(self.recording) {
            Ok(self.var)
        } else {
            Err(PyRuntimeError::new_err(FOREIGN))
        }
    }

    pub(crate) fn of(&self, var: Var) -> Self {
        Variable { var, ..*self }
    }

    pub(crate) fn map(&self, f: impl FnOnce(Var) -> Var) -> PyResult<Self> {
        Ok(self.of(f(self.here()?)))
    }

    /// `NotImplemented` for what is no number: the operand may be an array.
    fn with(
        &self,
        other: &Bound<'_, PyAny>,
        f: impl FnOnce(Var, Var) -> Var,
    ) -> PyResult<Py<PyAny>> {
        let py = other.py();
        let x = self.here()?;
        match number(other)? {
            Some(y) => Ok(Py::new(py, self.of(f(x, y)))?.into_any()),
            None => Ok(py.NotImplemented()),
        }
    }
}

/// A variable of the recording under way, or a constant; `None` for what is neither.
pub(crate) fn number(x: &Bound<'_, PyAny>) -> PyResult<Option<Var>> {
    match x.cast::<Variable>() {
        Ok(x) => x.get().here().map(Some),
        Err(_) => Ok(constant(x)?.map(Var::from)),
    }
}

/// Refuses the constant 0.
fn check_divisor(divisor: &Bound<'_, PyAny>) -> PyResult<()> {
    let divisor = match divisor.is_instance_of::<Variable>() {
        true => None,
        false => constant(divisor)?,
    };
    match divisor.is_some_and(|c| c.to::<f64>() == 0.0) {
        true => Err(PyValueError::new_err(BY_ZERO)),
        false => Ok(()),
    }
}

/// The integer next to x on the side of 0.
fn trunc(x: Var) -> Var {
    x.select(floor(x), -floor(-x))
}

/// The nearest integer, of two the larger one: that of even ones only is another function at single points.
fn nearest(x: Var) -> Var {
    floor(x + Var::from(0.5))
}

/// Refuses the third argument of `pow`.
fn no_modulus(modulus: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    match modulus {
        Some(modulus) if !modulus.is_none() => Err(PyTypeError::new_err(MODULUS)),
        _ => Ok(()),
    }
}

/// A ufunc of NumPy on variables, conditions or arrays of them.
pub(crate) fn apply(
    ufunc: &Bound<'_, PyAny>,
    method: &Bound<'_, PyAny>,
    inputs: &Bound<'_, PyTuple>,
    keywords: Option<&Bound<'_, PyDict>>,
) -> PyResult<Py<PyAny>> {
    let apply = ufunc.py().import("equip._arrays")?.getattr("apply")?;
    Ok(apply.call1((ufunc, method, inputs, keywords))?.unbind())
}

/// Any other function of NumPy on them.
pub(crate) fn call(
    function: &Bound<'_, PyAny>,
    arguments: &Bound<'_, PyTuple>,
    keywords: &Bound<'_, PyDict>,
) -> PyResult<Py<PyAny>> {
    let call = function.py().import("equip._arrays")?.getattr("call")?;
    Ok(call.call1((function, arguments, keywords))?.unbind())
}

#[pymethods]
impl Variable {
    fn sqrt(&self) -> PyResult<Self> {
        self.map(Var::sqrt)
    }
    fn exp(&self) -> PyResult<Self> {
        self.map(Var::exp)
    }
    fn expm1(&self) -> PyResult<Self> {
        self.map(Var::exp_m1)
    }
    fn log(&self) -> PyResult<Self> {
        self.map(Var::ln)
    }
    fn log1p(&self) -> PyResult<Self> {
        self.map(Var::ln_1p)
    }
    fn sin(&self) -> PyResult<Self> {
        self.map(Var::sin)
    }
    fn cos(&self) -> PyResult<Self> {
        self.map(Var::cos)
    }
    fn tan(&self) -> PyResult<Self> {
        self.map(Var::tan)
    }
    fn arcsin(&self) -> PyResult<Self> {
        self.map(Var::asin)
    }
    fn arccos(&self) -> PyResult<Self> {
        self.map(Var::acos)
    }
    fn arctan(&self) -> PyResult<Self> {
        self.map(Var::atan)
    }
    fn sinh(&self) -> PyResult<Self> {
        self.map(Var::sinh)
    }
    fn cosh(&self) -> PyResult<Self> {
        self.map(Var::cosh)
    }
    fn tanh(&self) -> PyResult<Self> {
        self.map(Var::tanh)
    }
    fn fabs(&self) -> PyResult<Self> {
        self.map(Var::abs)
    }
    fn __abs__(&self) -> PyResult<Self> {
        self.map(Var::abs)
    }
    fn reciprocal(&self) -> PyResult<Self> {
        self.map(Var::recip)
    }
    fn log2(&self) -> PyResult<Self> {
        self.map(|x| x.ln() / known(LN_2))
    }
    fn log10(&self) -> PyResult<Self> {
        self.map(Var::log10)
    }
    fn exp2(&self) -> PyResult<Self> {
        self.map(Var::exp2)
    }
    fn cbrt(&self) -> PyResult<Self> {
        self.map(Var::cbrt)
    }
    fn arcsinh(&self) -> PyResult<Self> {
        self.map(Var::asinh)
    }
    fn arccosh(&self) -> PyResult<Self> {
        self.map(Var::acosh)
    }
    fn arctanh(&self) -> PyResult<Self> {
        self.map(Var::atanh)
    }
    fn erf(&self) -> PyResult<Self> {
        self.map(Var::erf)
    }
    fn erfc(&self) -> PyResult<Self> {
        self.map(Var::erfc)
    }
    /// −1, 0 or 1.
    fn sign(&self) -> PyResult<Self> {
        self.map(Var::signum)
    }
    fn deg2rad(&self) -> PyResult<Self> {
        self.map(|x| known(DEGREE) * x)
    }
    fn rad2deg(&self) -> PyResult<Self> {
        self.map(|x| known(RADIAN) * x)
    }
    fn square(&self) -> PyResult<Self> {
        self.map(|x| x * x)
    }
    fn __neg__(&self) -> PyResult<Self> {
        self.map(|x| -x)
    }
    fn __pos__(&self) -> PyResult<Self> {
        self.map(|x| x)
    }
    fn conjugate(&self) -> PyResult<Self> {
        self.map(|x| x)
    }
    fn __add__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x + y)
    }
    fn __radd__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| y + x)
    }
    fn __sub__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x - y)
    }
    fn __rsub__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| y - x)
    }
    fn __mul__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x * y)
    }
    fn __rmul__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| y * x)
    }
    fn __truediv__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        check_divisor(other)?;
        self.with(other, |x, y| x / y)
    }
    fn __rtruediv__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| y / x)
    }
    fn minimum(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x.min(y))
    }
    fn maximum(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x.max(y))
    }
    fn hypot(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x.hypot(y))
    }
    /// Angle of the point (other, self).
    fn arctan2(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| x.atan2(y))
    }
    /// Angle of the point (self, other).
    fn arctan2_of(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |x, y| y.atan2(x))
    }
    /// Whole exponents are products, half-integer ones roots.
    fn __pow__(
        &self,
        other: &Bound<'_, PyAny>,
        modulus: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        no_modulus(modulus)?;
        if other.is_instance_of::<Variable>() {
            return self.with(other, Var::pow);
        }
        let Some(c) = constant(other)? else {
            return Ok(other.py().NotImplemented());
        };
        let power = c.to::<f64>();
        let x = self.here()?;
        let is_whole = c.to::<DoubleDouble>() == DoubleDouble::from(power.round());
        let var = if is_whole && power.abs() <= MOST {
            x.powi(power as i32)
        } else {
            x.powf(c)
        };
        Ok(Py::new(other.py(), self.of(var))?.into_any())
    }
    fn __rpow__(
        &self,
        other: &Bound<'_, PyAny>,
        modulus: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        no_modulus(modulus)?;
        self.with(other, |x, y| y.pow(x))
    }
    #[pyo3(signature = (ufunc, method, *inputs, **keywords))]
    fn __array_ufunc__(
        &self,
        ufunc: &Bound<'_, PyAny>,
        method: &Bound<'_, PyAny>,
        inputs: &Bound<'_, PyTuple>,
        keywords: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Py<PyAny>> {
        apply(ufunc, method, inputs, keywords)
    }
    fn __array_function__(
        &self,
        function: &Bound<'_, PyAny>,
        _types: &Bound<'_, PyAny>,
        arguments: &Bound<'_, PyTuple>,
        keywords: &Bound<'_, PyDict>,
    ) -> PyResult<Py<PyAny>> {
        call(function, arguments, keywords)
    }
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
    fn __bool__(&self) -> PyResult<bool> {
        Err(PyTypeError::new_err(TRUTH))
    }
    fn __float__(&self) -> PyResult<f64> {
        Err(PyTypeError::new_err(NUMBER))
    }
    fn __int__(&self) -> PyResult<i64> {
        Err(PyTypeError::new_err(NUMBER))
    }
    fn __complex__(&self) -> PyResult<f64> {
        Err(PyTypeError::new_err(NUMBER))
    }
    fn floor(&self) -> PyResult<Self> {
        self.map(floor)
    }
    fn ceil(&self) -> PyResult<Self> {
        self.map(|x| -floor(-x))
    }
    fn trunc(&self) -> PyResult<Self> {
        self.map(trunc)
    }
    /// The nearest integer, of two the larger one.
    fn rint(&self) -> PyResult<Self> {
        self.map(nearest)
    }
    fn __mod__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        check_divisor(other)?;
        self.with(other, |x, y| x - floor(x / y) * y)
    }
    fn __rmod__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |y, x| x - floor(x / y) * y)
    }
    fn __floordiv__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        check_divisor(other)?;
        self.with(other, |x, y| floor(x / y))
    }
    fn __rfloordiv__(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |y, x| floor(x / y))
    }
    fn __divmod__(&self, other: &Bound<'_, PyAny>) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
        Ok((self.__floordiv__(other)?, self.__mod__(other)?))
    }
    fn __rdivmod__(&self, other: &Bound<'_, PyAny>) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
        Ok((self.__rfloordiv__(other)?, self.__rmod__(other)?))
    }
    /// The remainder with the sign of self.
    fn fmod(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        check_divisor(other)?;
        self.with(other, |x, y| x - trunc(x / y) * y)
    }
    /// The remainder of other by self, with the sign of other.
    fn fmod_of(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
        self.with(other, |y, x| x - trunc(x / y) * y)
    }
    fn __floor__(&self) -> PyResult<Self> {
        self.floor()
    }
    fn __ceil__(&self) -> PyResult<Self> {
        self.ceil()
    }
    fn __trunc__(&self) -> PyResult<Self> {
        self.trunc()
    }
    /// Itself, as numbers of NumPy have it.
    fn item(&self) -> PyResult<Self> {
        self.map(|x| x)
    }
    #[pyo3(signature = (digits=None))]
    fn __round__(&self, digits: Option<i32>) -> PyResult<Self> {
        let Some(digits) = digits.filter(|&digits| digits != 0) else {
            return self.rint();
        };
        let power = Var::from(10.0).powi(digits.abs().min(MOST_DIGITS));
        self.map(|x| match digits > 0 {
            true => nearest(x * power) / power,
            false => nearest(x / power) * power,
        })
    }
    fn __hash__(&self) -> PyResult<isize> {
        Err(PyTypeError::new_err(HASHED))
    }
    fn __repr__(&self) -> &'static str {
        "<variable of H>"
    }
}
