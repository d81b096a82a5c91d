//! Cubic polynomials Σ c_k tᵏ and their derivatives, and the form of derivatives in double-double.

use equip_scalar::{DoubleDouble, Float};

/// The derivative of this order at t.
#[inline(always)]
pub(super) fn derivative<T: Float>([c0, c1, c2, c3]: [T; 4], order: u8, t: T) -> T {
    match order {
        0 => ((c3 * t + c2) * t + c1) * t + c0,
        1 => (T::int(3) * c3 * t + (c2 + c2)) * t + c1,
        2 => T::int(6) * c3 * t + (c2 + c2),
        3 => T::int(6) * c3,
        _ => T::int(0),
    }
}

/// The two words of a double-double.
pub(super) fn words(x: DoubleDouble) -> [f64; 2] {
    [x.hi(), x.lo()]
}
