//! √, ∛, √(x² + y²) and whole powers.

use super::{parts, scaled};
use crate::own::{Arithmetic, Own};

/// By Newton's iteration from 53 bits: 106, 212, 424.
pub(in crate::own) fn sqrt<A: Arithmetic>(x: Own<A>) -> Own<A> {
    if x == Own::small(0.0) || x == Own(A::INFINITY) {
        return x;
    }
    if !(x > Own::small(0.0)) {
        return Own(A::NAN);
    }
    let (m, k) = parts(x);
    let m = scaled(m, k & 1);
    let mut y = Own::small(m.hi().sqrt());
    for _ in 0..3 {
        y = y + (m - y * y) / (y + y);
    }
    scaled(y, (k - (k & 1)) / 2)
}

/// By Halley's iteration from 53 bits: 159, 477.
pub(in crate::own) fn cbrt<A: Arithmetic>(x: Own<A>) -> Own<A> {
    if x == Own::small(0.0) || !x.is_finite() {
        return x;
    }
    let (m, k) = parts(x);
    let rest = k.rem_euclid(3);
    let m = scaled(m, rest);
    let mut y = Own::small(m.hi().cbrt());
    for _ in 0..2 {
        let cube = y * y * y;
        y = y + y * (m - cube) / (cube + cube + m);
    }
    scaled(y, (k - rest) / 3)
}

pub(in crate::own) fn hypot<A: Arithmetic>(x: Own<A>, y: Own<A>) -> Own<A> {
    let (x, y) = (x.abs(), y.abs());
    if x.is_infinite() || y.is_infinite() {
        return Own(A::INFINITY);
    }
    let (large, small) = if x >= y { (x, y) } else { (y, x) };
    if small == Own::small(0.0) || !large.is_finite() {
        return large + small;
    }
    let ratio = small / large;
    large * (Own::small(1.0) + ratio * ratio).sqrt()
}

/// By squaring.
pub(in crate::own) fn powi<A: Arithmetic>(x: Own<A>, n: i32) -> Own<A> {
    let mut exponent = n.unsigned_abs();
    let (mut square, mut power) = (x, None);
    while exponent > 0 {
        if exponent & 1 == 1 {
            power = Some(power.map_or(square, |power| power * square));
        }
        exponent >>= 1;
        if exponent > 0 {
            square = square * square;
        }
    }
    let power = power.unwrap_or(Own::small(1.0));
    if n < 0 { power.recip() } else { power }
}
