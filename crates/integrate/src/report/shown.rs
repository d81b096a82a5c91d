//! The format of numbers in certificates.

use equip_scalar::Float;

/// Numbers from this size on are printed with an exponent.
pub(crate) const LARGE: i64 = 1_000_000_000_000;

/// A time with six decimals, or with an exponent if it is very small or very large.
pub(crate) fn shown<T: Float>(x: T) -> String {
    if x == T::int(0) || (T::ratio(1, 100)..T::int(LARGE)).contains(&x.abs()) {
        format!("{x:.6}")
    } else {
        format!("{x:.6e}")
    }
}
