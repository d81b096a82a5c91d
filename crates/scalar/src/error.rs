//! [`ParseFloatError`]: a text that is no number; and numbers as messages print them.

use crate::traits::Float;

/// A decimal that could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a decimal number; write it like 0.012277471, -3 or 6.02e23")]
pub struct ParseFloatError {
    /// The offending text.
    pub text: String,
}

/// A number in digits that read back to it, with an exponent where it would have many zeros.
pub fn plain<T: Float>(x: T) -> String {
    if x == T::int(0) || (T::ratio(1, 100_000)..T::int(1_000_000_000_000)).contains(&x.abs()) {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}
