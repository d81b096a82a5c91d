//! Sine, cosine, tangent: Taylor series after an exact reduction modulo π/2.

use super::nested;
use crate::double_double::functions::reduction::turns;
use crate::own::{Arithmetic, Own};
use crate::traits::Float;

/// (n mod 4, r) with x = n·π/2 + r, |r| ≤ π/4; NaN beyond the range of doubles.
fn reduced<A: Arithmetic>(x: Own<A>) -> (u32, Own<A>) {
    let size = x.hi().abs();
    if size <= std::f64::consts::FRAC_PI_4 {
        return (0, x);
    }
    if !size.is_finite() {
        return (0, Own(A::NAN));
    }
    let (quadrant, fraction) = turns(&x.expansion());
    (quadrant, Own::from_expansion(fraction) * Own::pi_over(2.0))
}

/// sin r for |r| ≤ π/4.
pub(super) fn sine<A: Arithmetic>(r: Own<A>) -> Own<A> {
    r * nested(r * r, 0.62, |j| -2.0 * j * (2.0 * j + 1.0))
}

/// cos r for |r| ≤ π/4.
pub(super) fn cosine<A: Arithmetic>(r: Own<A>) -> Own<A> {
    nested(r * r, 0.62, |j| -2.0 * j * (2.0 * j - 1.0))
}

fn quarter<A: Arithmetic>(quadrant: u32, r: Own<A>) -> Own<A> {
    match quadrant & 3 {
        0 => sine(r),
        1 => cosine(r),
        2 => -sine(r),
        _ => -cosine(r),
    }
}

pub(in crate::own) fn sin<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let (quadrant, r) = reduced(x);
    quarter(quadrant, r)
}

pub(in crate::own) fn cos<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let (quadrant, r) = reduced(x);
    quarter(quadrant + 1, r)
}

pub(in crate::own) fn tan<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let (quadrant, r) = reduced(x);
    quarter(quadrant, r) / quarter(quadrant + 1, r)
}
