//! The format of numbers in messages.

use super::float::Float;

/// A number with digits that read back exactly, and with an exponent if it would have many zeros.
pub fn plain<T: Float>(x: T) -> String {
    if x == T::int(0) || (T::ratio(1, 100_000)..T::int(1_000_000_000_000)).contains(&x.abs()) {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}
