//! [`ParseFloatError`]: a text that is not a number.

/// A decimal that could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{text}` is not a decimal number; write it like 0.012277471, -3 or 6.02e23")]
pub struct ParseFloatError {
    /// The offending text.
    pub text: String,
}
