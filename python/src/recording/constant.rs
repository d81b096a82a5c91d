//! Numbers of Python as constants of H: exact for int, Fraction, Decimal and text.

use crate::faults::value_error;
use equip::prelude::{DoubleDouble, ratio};
use equip::scalar::Constant;
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyString};

const COMPLEX: &str = "H is real: use no complex numbers in it";

/// Integers up to this are doubles.
const EXACT: u64 = 1 << 53;

fn by_text(text: &str) -> PyResult<Constant> {
    Constant::from_text(text).map_err(value_error)
}

fn integer(n: i64) -> Constant {
    if n.unsigned_abs() <= EXACT {
        Constant::double(n as f64)
    } else {
        ratio(n, 1)
    }
}

/// The constant that a Python number is; `None` for what is no number.
pub(crate) fn constant(x: &Bound<'_, PyAny>) -> PyResult<Option<Constant>> {
    if let Ok(x) = x.cast::<PyFloat>() {
        return Ok(Some(Constant::double(x.value())));
    }
    if let Ok(text) = x.cast::<PyString>() {
        return by_text(&text.to_cow()?).map(Some);
    }
    // Not by `Display`, which calls handlers of signals and drops what they raise.
    let name = x.get_type().name()?;
    let kind = name.to_cow()?;
    match &*kind {
        "Decimal" => by_text(&x.str()?.to_cow()?).map(Some),
        "Fraction" => fraction(x).map(Some),
        "longdouble" | "float128" => long_double(x).map(Some),
        "float16" | "float32" | "bool" | "bool_" => {
            let x: f64 = x.call_method0("__float__")?.extract()?;
            Ok(Some(Constant::double(x)))
        }
        name if name.starts_with("complex") || name == "clongdouble" => {
            Err(PyTypeError::new_err(COMPLEX))
        }
        "ndarray" => Ok(None),
        _ => match whole(x)? {
            Some(n) => Ok(Some(integer(n))),
            None if kind == "int" => by_text(&x.str()?.to_cow()?).map(Some),
            None => Ok(None),
        },
    }
}

/// An integer of 64 bits; `None` for what is none. What else its `__index__` raises is raised.
fn whole(x: &Bound<'_, PyAny>) -> PyResult<Option<i64>> {
    match x.extract::<i64>() {
        Ok(n) => Ok(Some(n)),
        Err(error)
            if error.is_instance_of::<PyTypeError>(x.py())
                || error.is_instance_of::<PyOverflowError>(x.py()) =>
        {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}

fn fraction(x: &Bound<'_, PyAny>) -> PyResult<Constant> {
    let (above, below) = (x.getattr("numerator")?, x.getattr("denominator")?);
    if let (Some(n), Some(d)) = (whole(&above)?, whole(&below)?) {
        return Ok(ratio(n, d));
    }
    let wide = |part: Bound<'_, PyAny>| -> PyResult<DoubleDouble> {
        Ok(by_text(&part.str()?.to_cow()?)?.to())
    };
    let quotient = wide(above)? / wide(below)?;
    Ok(Constant::from_expansion(quotient.expansion()))
}

fn long_double(x: &Bound<'_, PyAny>) -> PyResult<Constant> {
    let high: f64 = x.call_method0("__float__")?.extract()?;
    let rest: f64 = x.sub(high)?.call_method0("__float__")?.extract()?;
    Ok(Constant::from_expansion([high, rest, 0.0, 0.0, 0.0, 0.0]))
}

/// A number as an unevaluated sum of two doubles.
#[pyfunction]
pub(crate) fn split(x: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
    let Some(c) = constant(x)? else {
        let name = x.get_type().name()?;
        let kind = name.to_cow()?;
        return Err(PyTypeError::new_err(format!(
            "{kind} is not a number; give float, int, Fraction, Decimal, np.longdouble or a decimal as text"
        )));
    };
    let x = c.to::<DoubleDouble>();
    Ok((x.hi(), x.lo()))
}

/// The decimal of an unevaluated sum of two doubles, to so many significant digits.
#[pyfunction]
pub(crate) fn decimal_text(high: f64, low: f64, digits: usize) -> String {
    let x = DoubleDouble::new(high, low);
    format!("{x:.*e}", digits.saturating_sub(1))
}
