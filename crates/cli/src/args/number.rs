//! Numbers on the command line.

use crate::fault::Fault;
use equip_scalar::Float;

/// A decimal or a quotient of decimals, in the precision of the run.
pub(crate) fn number<T: Float>(option: &'static str, text: &str) -> Result<T, Fault> {
    let read =
        |text: &str| T::decimal(text.trim()).map_err(|source| Fault::Number { option, source });
    match text.split_once('/') {
        Some((n, d)) => Ok(read(n)? / read(d)?),
        None => read(text),
    }
}

/// The same, if it is positive and finite.
pub(crate) fn positive<T: Float>(option: &'static str, text: &str) -> Result<T, Fault> {
    let x = number::<T>(option, text)?;
    match x > T::int(0) && x.is_finite() {
        true => Ok(x),
        false => Err(Fault::option(option, text, "positive and finite")),
    }
}
