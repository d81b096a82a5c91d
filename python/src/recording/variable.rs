//! [`Variable`]: a component of q or p, or what is computed of them, while H(q, p) is recorded.

#![allow(unsafe_op_in_unsafe_fn)] // In the code that `pymethods` makes of operators within a macro.

use crate::recording::constant::constant;
use equip::prelude::{DoubleDouble, Var};
use equip::tables::floor;
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
const BY_ZERO: &str = "a variable of H is divided by the constant 0; check the captured parameters";
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

    /// The same for a divisor, which is not the constant 0.
    fn divide(
        &self,
        divisor: &Bound<'_, PyAny>,
        f: impl FnOnce(Var, Var) -> Var,
    ) -> PyResult<Py<PyAny>> {
        let is_constant = !divisor.is_instance_of::<Variable>();
        if is_constant && constant(divisor)?.is_some_and(|c| c.to::<f64>() == 0.0) {
            return Err(PyValueError::new_err(BY_ZERO));
        }
        self.with(divisor, f)
    }
}

/// A variable of the recording under way, or a constant; `None` for what is neither.
pub(crate) fn number(x: &Bound<'_, PyAny>) -> PyResult<Option<Var>> {
    match x.cast::<Variable>() {
        Ok(x) => x.get().here().map(Some),
        Err(_) => Ok(constant(x)?.map(Var::from)),
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

/// The remainder with the sign of y.
fn remainder(x: Var, y: Var) -> Var {
    x - floor(x / y) * y
}

/// The remainder with the sign of x.
fn truncated_remainder(x: Var, y: Var) -> Var {
    x - trunc(x / y) * y
}

/// Refuses the third argument of `pow`.
fn no_modulus(modulus: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    match modulus {
        Some(modulus) if !modulus.is_none() => Err(PyTypeError::new_err(MODULUS)),
        _ => Ok(()),
    }
}

/// What NumPy calls on variables and conditions, in place of a function of its own.
macro_rules! called_by_numpy {
    ($class:ident) => {
        #[pymethods]
        impl $class {
            #[pyo3(signature = (ufunc, method, *inputs, **keywords))]
            fn __array_ufunc__(
                &self,
                ufunc: &Bound<'_, PyAny>,
                method: &Bound<'_, PyAny>,
                inputs: &Bound<'_, PyTuple>,
                keywords: Option<&Bound<'_, PyDict>>,
            ) -> PyResult<Py<PyAny>> {
                let apply = ufunc.py().import("equip._arrays")?.getattr("apply")?;
                Ok(apply.call1((ufunc, method, inputs, keywords))?.unbind())
            }
            fn __array_function__(
                &self,
                function: &Bound<'_, PyAny>,
                _types: &Bound<'_, PyAny>,
                arguments: &Bound<'_, PyTuple>,
                keywords: &Bound<'_, PyDict>,
            ) -> PyResult<Py<PyAny>> {
                let call = function.py().import("equip._arrays")?.getattr("call")?;
                Ok(call.call1((function, arguments, keywords))?.unbind())
            }
        }
    };
}
pub(crate) use called_by_numpy;

called_by_numpy!(Variable);

/// Methods that are functions of one number.
macro_rules! functions {
    ($($name:ident = $f:expr;)*) => {
        #[pymethods]
        impl Variable {
            $(fn $name(&self) -> PyResult<Self> {
                self.map($f)
            })*
        }
    };
}

functions! {
    sqrt = Var::sqrt;
    exp = Var::exp;
    expm1 = Var::exp_m1;
    log = Var::ln;
    log1p = Var::ln_1p;
    sin = Var::sin;
    cos = Var::cos;
    tan = Var::tan;
    arcsin = Var::asin;
    arccos = Var::acos;
    arctan = Var::atan;
    sinh = Var::sinh;
    cosh = Var::cosh;
    tanh = Var::tanh;
    fabs = Var::abs;
    __abs__ = Var::abs;
    reciprocal = Var::recip;
    log2 = |x| x.ln() / known(LN_2);
    log10 = Var::log10;
    exp2 = Var::exp2;
    cbrt = Var::cbrt;
    arcsinh = Var::asinh;
    arccosh = Var::acosh;
    arctanh = Var::atanh;
    erf = Var::erf;
    erfc = Var::erfc;
    sign = Var::signum;
    deg2rad = |x| known(DEGREE) * x;
    rad2deg = |x| known(RADIAN) * x;
    square = |x| x * x;
    floor = floor;
    __floor__ = floor;
    ceil = |x| -floor(-x);
    __ceil__ = |x| -floor(-x);
    trunc = trunc;
    __trunc__ = trunc;
    rint = nearest;
    __neg__ = |x| -x;
    __pos__ = |x| x;
    conjugate = |x| x;
    item = |x| x;
}

/// Methods that are functions of two numbers. Those that divide by the second one refuse the constant 0.
macro_rules! functions_of_two {
    ($($name:ident = $with:ident($f:expr);)*) => {
        #[pymethods]
        impl Variable {
            $(fn $name(&self, other: &Bound<'_, PyAny>) -> PyResult<Py<PyAny>> {
                self.$with(other, $f)
            })*
        }
    };
}

functions_of_two! {
    __add__ = with(|x, y| x + y);
    __radd__ = with(|x, y| y + x);
    __sub__ = with(|x, y| x - y);
    __rsub__ = with(|x, y| y - x);
    __mul__ = with(|x, y| x * y);
    __rmul__ = with(|x, y| y * x);
    __truediv__ = divide(|x, y| x / y);
    __rtruediv__ = with(|x, y| y / x);
    __mod__ = divide(remainder);
    __rmod__ = with(|x, y| remainder(y, x));
    __floordiv__ = divide(|x, y| floor(x / y));
    __rfloordiv__ = with(|x, y| floor(y / x));
    fmod = divide(truncated_remainder);
    fmod_of = with(|x, y| truncated_remainder(y, x));
    minimum = with(Var::min);
    maximum = with(Var::max);
    hypot = with(Var::hypot);
    arctan2 = with(Var::atan2);
    arctan2_of = with(|x, y| y.atan2(x));
}

#[pymethods]
impl Variable {
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
    fn __divmod__(&self, other: &Bound<'_, PyAny>) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
        Ok((self.__floordiv__(other)?, self.__mod__(other)?))
    }
    fn __rdivmod__(&self, other: &Bound<'_, PyAny>) -> PyResult<(Py<PyAny>, Py<PyAny>)> {
        Ok((self.__rfloordiv__(other)?, self.__rmod__(other)?))
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
