//! Inverse trigonometric functions, all by the arctangent.

use super::Real;
use super::trigonometric::{cosine, sine};

/// For |x| ≤ 1. A double y close to arctan x leaves arctan d, d = (x cos y − sin y)/(cos y + x sin y), of
/// which three terms are enough.
fn near<T: Real>(x: T) -> T {
    let y = T::exact(x.double().atan());
    let (s, c) = (sine(y), cosine(y));
    let d = (x * c - s) / (c + x * s);
    let square = d * d;
    let rest = square * (square / T::exact(5.0) - T::exact(1.0) / T::exact(3.0));
    y + (d + d * rest)
}

pub(crate) fn atan<T: Real>(x: T) -> T {
    atan2(x, T::exact(1.0))
}

pub(crate) fn atan2<T: Real>(y: T, x: T) -> T {
    let zero = T::exact(0.0);
    let is_special = x == zero || y == zero || !x.is_finite() || !y.is_finite();
    if is_special {
        // A whole number of eighths of a turn.
        let angle = y.double().atan2(x.double());
        let eighths = (angle / std::f64::consts::FRAC_PI_4).round();
        return T::exact(eighths) * T::FRAC_PI_4();
    }
    if y.abs() > x.abs() {
        return T::FRAC_PI_2().copysign(y) - near(x / y);
    }
    let angle = near(y / x);
    if x > zero {
        angle
    } else {
        angle + T::PI().copysign(y)
    }
}

fn other_side<T: Real>(x: T) -> T {
    ((T::exact(1.0) - x) * (T::exact(1.0) + x)).sqrt()
}

pub(crate) fn asin<T: Real>(x: T) -> T {
    atan2(x, other_side(x))
}

pub(crate) fn acos<T: Real>(x: T) -> T {
    atan2(other_side(x), x)
}
