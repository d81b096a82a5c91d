//! Inverse trigonometric functions, all by the arctangent.

use super::trigonometric::{cosine, sine};
use crate::own::{Arithmetic, Own};

/// For |x| ≤ 1. A double y close to arctan x leaves arctan d, d = (x cos y − sin y)/(cos y + x sin y), of
/// which three terms are enough.
fn near<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let y = Own::small(x.hi().atan());
    let (s, c) = (sine(y), cosine(y));
    let d = (x * c - s) / (c + x * s);
    let square = d * d;
    let rest = square * (square / Own::small(5.0) - Own::small(1.0) / Own::small(3.0));
    y + (d + d * rest)
}

pub(in crate::own) fn atan<A: Arithmetic>(x: Own<A>) -> Own<A> {
    atan2(x, Own::small(1.0))
}

pub(in crate::own) fn atan2<A: Arithmetic>(y: Own<A>, x: Own<A>) -> Own<A> {
    let zero = Own::small(0.0);
    let is_special = x == zero || y == zero || !x.is_finite() || !y.is_finite();
    if is_special {
        // A whole number of eighths of a turn.
        let angle = y.hi().atan2(x.hi());
        let eighths = (angle / std::f64::consts::FRAC_PI_4).round();
        return Own::small(eighths) * Own::pi_over(4.0);
    }
    if y.abs() > x.abs() {
        return Own::pi_over(2.0).copysign(y) - near(x / y);
    }
    let angle = near(y / x);
    if x > zero {
        angle
    } else {
        angle + Own::pi_over(1.0).copysign(y)
    }
}

fn other_side<A: Arithmetic>(x: Own<A>) -> Own<A> {
    ((Own::small(1.0) - x) * (Own::small(1.0) + x)).sqrt()
}

pub(in crate::own) fn asin<A: Arithmetic>(x: Own<A>) -> Own<A> {
    atan2(x, other_side(x))
}

pub(in crate::own) fn acos<A: Arithmetic>(x: Own<A>) -> Own<A> {
    atan2(other_side(x), x)
}
