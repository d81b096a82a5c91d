//! erf and erfc.
//!
//! erf x for |x| < 1: its Taylor series. erfc x for x ≥ ½: the trapezoidal rule for
//!
//! erfc x = (x/π) exp(−x²) ∫ exp(−t²)/(t² + x²) dt
//!
//! with the residue of the pole at t = ix [Chiarella, Reichel 1968; Hunter, Regan 1972]; with the step h its
//! error is exp(−(π/h)²) of the result, here 5e-37. All else by erf(−x) = −erf x and erfc x = 1 − erf x.

use crate::double_double::number::{DoubleDouble, dd};
use std::sync::OnceLock;

/// Step h of the trapezoidal rule.
const STEP: f64 = 0.34375;
/// Nodes of the rule; exp(−(27 h)²) is 4e-38.
const NODES: usize = 26;
/// Terms of the series; the next is 4e-36 at x = 1.
const TERMS: usize = 31;

/// (−1)ⁿ/(n!(2n + 1)) for n = 0, 1, …
fn coefficients() -> &'static [DoubleDouble; TERMS] {
    static COEFFICIENTS: OnceLock<[DoubleDouble; TERMS]> = OnceLock::new();
    COEFFICIENTS.get_or_init(|| {
        let mut signed = DoubleDouble::ONE;
        std::array::from_fn(|n| {
            if n > 0 {
                signed = -signed.over(dd(n as f64, 0.0));
            }
            signed.over(dd((2 * n + 1) as f64, 0.0))
        })
    })
}

/// exp(−(kh)²) for k = 1, 2, …
fn weights() -> &'static [DoubleDouble; NODES] {
    static WEIGHTS: OnceLock<[DoubleDouble; NODES]> = OnceLock::new();
    WEIGHTS.get_or_init(|| {
        std::array::from_fn(|k| {
            let t = STEP * (k + 1) as f64;
            dd(-t * t, 0.0).exp()
        })
    })
}

/// exp(−x²): x² of the leading 24 bits is exact, and what is left of the exponent is small.
fn gaussian(x: DoubleDouble) -> DoubleDouble {
    let head = f64::from(x.hi as f32);
    let rest = x.plus_double(-head).times(x.plus_double(head));
    dd(-head * head, 0.0).exp().times((-rest).exp())
}

/// For |x| < 1.
fn series(x: DoubleDouble) -> DoubleDouble {
    let square = x.times(x);
    let mut sum = DoubleDouble::ZERO;
    for &c in coefficients().iter().rev() {
        sum = sum.times(square).plus(c);
    }
    sum.times(x).times(DoubleDouble::FRAC_2_SQRT_PI)
}

/// erfc x for x ≥ ½.
fn tail(x: DoubleDouble) -> DoubleDouble {
    if x.hi > 28.0 {
        return DoubleDouble::ZERO;
    }
    let square = x.times(x);
    let mut sum = DoubleDouble::ZERO;
    for (k, &weight) in weights().iter().enumerate().rev() {
        let t = STEP * (k + 1) as f64;
        sum = sum.plus(weight.over(square.plus_double(t * t)));
    }
    let sum = sum.plus(sum).plus(square.recip());
    let factor = x.times_double(STEP).times(DoubleDouble::FRAC_1_PI);
    let integral = factor.times(sum).times(gaussian(x));
    // Beyond π/h the residue is less than the error of the rule.
    if x.hi * STEP > 3.0 {
        return integral;
    }
    let turns = DoubleDouble::TAU.times(x).over(dd(STEP, 0.0));
    let residue = dd(2.0, 0.0).over(turns.exp_m1());
    integral.plus(-residue)
}

impl DoubleDouble {
    /// Error function 2/√π ∫₀ˣ exp(−t²) dt.
    pub fn erf(self) -> Self {
        if self.hi.is_nan() || self.hi.abs() < 1.0 {
            return series(self);
        }
        (-tail(self.abs())).plus_double(1.0).copysign(self)
    }

    /// 1 − erf x, with full relative precision where that is small.
    pub fn erfc(self) -> Self {
        if self.hi >= 0.5 {
            return tail(self);
        }
        (-self.erf()).plus_double(1.0)
    }
}
