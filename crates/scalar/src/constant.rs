//! [`Constant`]: a constant in H that is not limited to the precision of `f64`.

use crate::error::ParseFloatError;
use std::collections::HashSet;
use std::sync::{LazyLock, Mutex, PoisonError};

/// A number as an unevaluated sum of doubles, largest first: up to 318 bits.
pub type Words = [f64; 6];

/// A constant that is evaluated in the floating-point type of the run.
///
/// An `f64` literal in a 31-digit run silently limits it to 16 digits unless it is exactly representable
/// (`0.5`, `2.0`, `-0.75` are; `0.1` is not). [`ratio`] and [`decimal`] have no such limit.
///
/// Its value in `f64` is stored as well, so in `f64` a constant costs no more than a literal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constant {
    pub(crate) double: f64,
    pub(crate) written: Written,
}

/// How a [`Constant`] was written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Written {
    /// Exactly this double.
    Double(f64),
    /// A quotient of two integers, divided in the target type.
    Ratio(i64, i64),
    /// A decimal, parsed in the target type.
    Decimal(&'static str),
    /// A value captured from an extended type: an unevaluated sum, largest part first.
    Extended(Words),
}

impl Constant {
    /// Exactly this double.
    #[inline(always)]
    pub const fn double(x: f64) -> Self {
        Constant {
            double: x,
            written: Written::Double(x),
        }
    }

    /// The sum of an expansion made by [`Float::expansion`](crate::Float::expansion).
    #[inline]
    pub fn from_expansion(parts: Words) -> Self {
        Constant {
            double: parts.iter().rev().fold(0.0, |sum, part| sum + part),
            written: Written::Extended(parts),
        }
    }

    /// A decimal that is known at run time only, for example from a file. Its text is stored once, for the
    /// life of the process.
    ///
    /// # Errors
    /// As [`decimal`].
    ///
    /// ```
    /// use equip_scalar::{Constant, decimal};
    /// let text = String::from("0.1");
    /// assert_eq!(Constant::from_text(&text)?, decimal("0.1")?);
    /// # Ok::<(), equip_scalar::ParseFloatError>(())
    /// ```
    pub fn from_text(text: &str) -> Result<Self, ParseFloatError> {
        static KEPT: LazyLock<Mutex<HashSet<&'static str>>> = LazyLock::new(Mutex::default);
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = kept.get(text) {
            return decimal(known);
        }
        text.trim()
            .parse::<f64>()
            .map_err(|_| ParseFloatError { text: text.into() })?;
        let new: &'static str = Box::leak(text.to_owned().into_boxed_str());
        kept.insert(new);
        decimal(new)
    }

    /// The constant in `f64`.
    #[inline(always)]
    pub(crate) const fn to_double(self) -> f64 {
        self.double
    }

    /// The form in which the constant was written.
    pub fn written(self) -> Written {
        self.written
    }
}

/// n/d, divided in the floating-point type of the run: `ratio(1, 3) * q[0].powi(3)`.
#[inline(always)]
pub const fn ratio(n: i64, d: i64) -> Constant {
    Constant {
        double: n as f64 / d as f64,
        written: Written::Ratio(n, d),
    }
}

/// A decimal, parsed in the floating-point type of the run: `let mu = decimal("0.012277471")?;`.
///
/// # Errors
/// [`ParseFloatError`] if the text is not a decimal number.
pub fn decimal(text: &'static str) -> Result<Constant, ParseFloatError> {
    match text.trim().parse() {
        Ok(double) => Ok(Constant {
            double,
            written: Written::Decimal(text),
        }),
        Err(_) => Err(ParseFloatError { text: text.into() }),
    }
}

impl From<f64> for Constant {
    #[inline(always)]
    fn from(x: f64) -> Self {
        Constant::double(x)
    }
}

impl From<i32> for Constant {
    #[inline(always)]
    fn from(n: i32) -> Self {
        Constant::double(f64::from(n))
    }
}
