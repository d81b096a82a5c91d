//! √, ∛, √(x² + y²) and whole powers.

use super::{Real, parts, scaled};
use crate::traits::half_power::by_squares;

/// By Newton's iteration from 53 bits: 106, 212, 424.
pub(crate) fn sqrt<T: Real>(x: T) -> T {
    if x == T::exact(0.0) || x == T::infinity() {
        return x;
    }
    if !(x > T::exact(0.0)) {
        return T::nan();
    }
    let (m, k) = parts(x);
    let m = scaled(m, k & 1);
    let mut y = T::exact(m.double().sqrt());
    for _ in 0..3 {
        y = y + (m - y * y) / (y + y);
    }
    scaled(y, (k - (k & 1)) / 2)
}

/// By Halley's iteration from 53 bits: 159, 477.
pub(crate) fn cbrt<T: Real>(x: T) -> T {
    if x == T::exact(0.0) || !x.is_finite() {
        return x;
    }
    let (m, k) = parts(x);
    let rest = k.rem_euclid(3);
    let m = scaled(m, rest);
    let mut y = T::exact(m.double().cbrt());
    for _ in 0..2 {
        let cube = y * y * y;
        y = y + y * (m - cube) / (cube + cube + m);
    }
    scaled(y, (k - rest) / 3)
}

pub(crate) fn hypot<T: Real>(x: T, y: T) -> T {
    let (x, y) = (x.abs(), y.abs());
    if x.is_infinite() || y.is_infinite() {
        return T::infinity();
    }
    let (large, small) = if x >= y { (x, y) } else { (y, x) };
    if small == T::exact(0.0) || !large.is_finite() {
        return large + small;
    }
    let ratio = small / large;
    large * (T::exact(1.0) + ratio * ratio).sqrt()
}

/// By squaring.
pub(crate) fn powi<T: Real>(x: T, n: i32) -> T {
    let power = by_squares(x, n.unsigned_abs()).unwrap_or(T::exact(1.0));
    if n < 0 { power.recip() } else { power }
}
