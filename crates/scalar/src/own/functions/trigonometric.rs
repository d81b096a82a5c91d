//! Sine, cosine, tangent: Taylor series after an exact reduction modulo π/2.

use super::{Real, nested, sum, words};
use crate::double_double::functions::reduction::turns;

/// (n mod 4, r) with x = n·π/2 + r, |r| ≤ π/4; NaN beyond the range of doubles.
fn reduced<T: Real>(x: T) -> (u32, T) {
    let size = x.double().abs();
    if size <= std::f64::consts::FRAC_PI_4 {
        return (0, x);
    }
    if !size.is_finite() {
        return (0, T::nan());
    }
    let (quadrant, fraction) = turns::<6>(&words::<_, 6>(x));
    (quadrant, sum::<T>(&fraction) * T::FRAC_PI_2())
}

/// sin r for |r| ≤ π/4.
pub(super) fn sine<T: Real>(r: T) -> T {
    r * nested(r * r, 0.62, |j| -2.0 * j * (2.0 * j + 1.0))
}

/// cos r for |r| ≤ π/4.
pub(super) fn cosine<T: Real>(r: T) -> T {
    nested(r * r, 0.62, |j| -2.0 * j * (2.0 * j - 1.0))
}

fn quarter<T: Real>(quadrant: u32, r: T) -> T {
    match quadrant & 3 {
        0 => sine(r),
        1 => cosine(r),
        2 => -sine(r),
        _ => -cosine(r),
    }
}

pub(crate) fn sin<T: Real>(x: T) -> T {
    let (quadrant, r) = reduced(x);
    quarter(quadrant, r)
}

pub(crate) fn cos<T: Real>(x: T) -> T {
    let (quadrant, r) = reduced(x);
    quarter(quadrant + 1, r)
}

pub(crate) fn tan<T: Real>(x: T) -> T {
    let (quadrant, r) = reduced(x);
    quarter(quadrant, r) / quarter(quadrant + 1, r)
}
