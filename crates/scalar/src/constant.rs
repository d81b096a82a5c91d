//! [`Constant`]: a constant in H that no `f64` caps.

use crate::{Float, ParseFloatError};

/// A constant that is evaluated in whatever float type H is later computed in.
///
/// An `f64` literal in a 31-digit run silently limits it to 16 digits unless it is exactly representable
/// (`0.5`, `2.0`, `-0.75` are; `0.1` is not). [`ratio`] and [`decimal`] have no such limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Constant {
    /// Exactly this double.
    Double(f64),
    /// A quotient of two integers, divided in the target type.
    Ratio(i64, i64),
    /// A decimal, parsed in the target type; checked when made by [`decimal`].
    Decimal(&'static str),
    /// A value captured from an extended type: an unevaluated sum, largest part first.
    Extended([f64; 4]),
}

impl Constant {
    /// The constant in the float type `T`.
    pub fn to<T: Float>(self) -> T {
        match self {
            Constant::Double(x) => T::exact(x),
            Constant::Ratio(n, d) => T::ratio(n, d),
            Constant::Decimal(text) => T::decimal(text).unwrap_or(T::NAN),
            Constant::Extended(parts) => T::from_expansion(parts),
        }
    }
}

/// n/d, divided in the float type H is computed in: `ratio(1, 3) * q[0].powi(3)`.
pub fn ratio(n: i64, d: i64) -> Constant {
    Constant::Ratio(n, d)
}

/// A decimal, read in the float type H is computed in: `let mu = decimal("0.012277471")?;`.
///
/// # Errors
/// [`ParseFloatError`] when the text is not a decimal number.
pub fn decimal(text: &'static str) -> Result<Constant, ParseFloatError> {
    f64::decimal(text).map(|_| Constant::Decimal(text))
}

impl From<f64> for Constant {
    fn from(x: f64) -> Self {
        Constant::Double(x)
    }
}

impl From<i32> for Constant {
    fn from(n: i32) -> Self {
        Constant::Double(f64::from(n))
    }
}

impl From<crate::DoubleDouble> for Constant {
    fn from(x: crate::DoubleDouble) -> Self {
        Constant::Extended(x.expansion())
    }
}
