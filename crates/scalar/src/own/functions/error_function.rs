//! erf and erfc, by the formulas of double-double; ε determines the step and the number of terms.
//!
//! erf x for |x| < 1: (2x/√π) exp(−x²) Σ (2x²)ⁿ/(2n + 1)!!. erfc x for x ≥ ½: the trapezoidal rule for
//! (x/π) exp(−x²) ∫ exp(−t²)/(t² + x²) dt with the residue of the pole at t = ix [Chiarella, Reichel 1968;
//! Hunter, Regan 1972].

use super::{Real, nested};
use std::f64::consts;

/// exp(−x²): x² of the leading 24 bits is exact, and what is left of the exponent is small.
fn gaussian<T: Real>(x: T) -> T {
    let head = T::exact(f64::from(x.double() as f32));
    (-(head * head)).exp() * (-((x - head) * (x + head))).exp()
}

pub(crate) fn erf<T: Real>(x: T) -> T {
    if x.double().abs() >= 1.0 {
        return (T::exact(1.0) - tail(x.abs())).copysign(x);
    }
    let square = x * x;
    let sum = nested(square, 1.0, |j| j + 0.5);
    x * T::FRAC_2_SQRT_PI() * (-square).exp() * sum
}

pub(crate) fn erfc<T: Real>(x: T) -> T {
    if x.double() >= 0.5 {
        return tail(x);
    }
    T::exact(1.0) - erf(x)
}

/// erfc x for x ≥ ½.
fn tail<T: Real>(x: T) -> T {
    if x.double() > 6000.0 {
        return T::exact(0.0);
    }
    // The error of the rule is exp(−(π/h)²), and so is the last weight.
    let exponent = 6.0 * consts::LN_2 - T::epsilon().double().ln();
    let step = (64.0 * consts::PI / exponent.sqrt()).floor() / 64.0;
    let nodes = (exponent.sqrt() / step).ceil() as i32;
    let square = x * x;
    let mut sum = T::exact(0.0);
    for k in (1..=nodes).rev() {
        let t = step * f64::from(k);
        let t = T::exact(t * t);
        sum = sum + (-t).exp() / (square + t);
    }
    let sum = sum + sum + square.recip();
    let integral = x * T::exact(step) * T::FRAC_1_PI() * sum * gaussian(x);
    if x.double() > consts::PI / step {
        return integral;
    }
    let turns = T::TAU() * x / T::exact(step);
    integral - T::exact(2.0) / turns.exp_m1()
}
