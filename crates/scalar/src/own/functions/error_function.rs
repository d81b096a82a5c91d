//! erf and erfc, as those of double-double, with a step and as many terms as ε asks for.
//!
//! erf x for |x| < 1: (2x/√π) exp(−x²) Σ (2x²)ⁿ/(2n + 1)!!. erfc x for x ≥ ½: the trapezoidal rule for
//! (x/π) exp(−x²) ∫ exp(−t²)/(t² + x²) dt with the residue of the pole at t = ix [Chiarella, Reichel 1968;
//! Hunter, Regan 1972].

use super::nested;
use crate::own::{Arithmetic, Own};
use num_traits::FloatConst;
use std::f64::consts;

/// exp(−x²): x² of the leading 24 bits is exact, and what is left of the exponent is small.
fn gaussian<A: Arithmetic>(x: Own<A>) -> Own<A> {
    let head = Own::small(f64::from(x.hi() as f32));
    (-(head * head)).exp() * (-((x - head) * (x + head))).exp()
}

pub(in crate::own) fn erf<A: Arithmetic>(x: Own<A>) -> Own<A> {
    if x.hi().abs() >= 1.0 {
        return (Own::small(1.0) - tail(x.abs())).copysign(x);
    }
    let square = x * x;
    let sum = nested(square, 1.0, |j| j + 0.5);
    x * Own::FRAC_2_SQRT_PI() * (-square).exp() * sum
}

pub(in crate::own) fn erfc<A: Arithmetic>(x: Own<A>) -> Own<A> {
    if x.hi() >= 0.5 {
        return tail(x);
    }
    Own::small(1.0) - erf(x)
}

/// erfc x for x ≥ ½.
fn tail<A: Arithmetic>(x: Own<A>) -> Own<A> {
    if x.hi() > 6000.0 {
        return Own::small(0.0);
    }
    // The error of the rule is exp(−(π/h)²), and so is the last weight.
    let exponent = f64::from(A::MANTISSA_BITS + 6) * consts::LN_2;
    let step = (64.0 * consts::PI / exponent.sqrt()).floor() / 64.0;
    let nodes = (exponent.sqrt() / step).ceil() as i32;
    let square = x * x;
    let mut sum = Own::small(0.0);
    for k in (1..=nodes).rev() {
        let t = step * f64::from(k);
        let t = Own::small(t * t);
        sum = sum + (-t).exp() / (square + t);
    }
    let sum = sum + sum + square.recip();
    let integral = x * Own::small(step) * Own::FRAC_1_PI() * sum * gaussian(x);
    if x.hi() > consts::PI / step {
        return integral;
    }
    let turns = Own::TAU() * x / Own::small(step);
    integral - Own::small(2.0) / turns.exp_m1()
}
