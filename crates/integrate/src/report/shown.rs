//! Numbers as certificates print them.

use equip_scalar::Float;

/// From here on numbers are printed with an exponent.
pub(crate) const LARGE: i64 = 1_000_000_000_000;

/// A time: six decimals, and as many digits where they would be zeros or none of them would be significant.
pub(crate) fn shown<T: Float>(x: T) -> String {
    if x == T::int(0) || (T::ratio(1, 100)..T::int(LARGE)).contains(&x.abs()) {
        format!("{x:.6}")
    } else {
        format!("{x:.6e}")
    }
}
