//! `f64` as [`Scalar`] and [`Float`].

use crate::constant::Words;
use crate::error::ParseFloatError;
use crate::forward::Forward;
use crate::kernels::Lanes;
use crate::traits::{Float, Outside, Scalar, scalar_glue};
use std::sync::Arc;

impl Scalar for f64 {
    scalar_glue!();
    /// ln(1 + (t + √(t(t + 2)))), t = x − 1: near 1 the logarithm of x + √(x² − 1) has half of the digits.
    #[inline(always)]
    fn acosh(x: f64) -> f64 {
        if x < 1e100 {
            let t = x - 1.0;
            (t + (t * (t + 2.0)).sqrt()).ln_1p()
        } else {
            x.ln() + std::f64::consts::LN_2
        }
    }
    /// ½ ln(1 + 2x/(1 − x)) for x ≥ 0: near −1 the quotient would have no correct digit.
    #[inline(always)]
    fn atanh(x: f64) -> f64 {
        let size = x.abs();
        (0.5 * ((size + size) / (1.0 - size)).ln_1p()).copysign(x)
    }
    #[inline(always)]
    fn erf(x: f64) -> f64 {
        libm::erf(x)
    }
    #[inline(always)]
    fn erfc(x: f64) -> f64 {
        libm::erfc(x)
    }
    #[inline(always)]
    fn outside(f: &Arc<dyn Outside>, orders: [u8; 2], x: [f64; 2]) -> f64 {
        f.derivative(orders, x)
    }
}

impl Float for f64 {
    const NAME: &'static str = "f64";
    const MANTISSA_BITS: u32 = f64::MANTISSA_DIGITS;
    const ROUND_TRIP_DIGITS: usize = 17;
    const EPSILON: f64 = f64::EPSILON;
    const MAX: f64 = f64::MAX;
    const MIN_POSITIVE: f64 = f64::MIN_POSITIVE;
    const INFINITY: f64 = f64::INFINITY;
    const NAN: f64 = f64::NAN;

    const IS_DOUBLE: bool = true;
    const WIDTH: usize = 8;
    type Pack<const N: usize> = Lanes<N>;
    type Forward<const N: usize> = Forward<f64, N>;

    #[inline(always)]
    fn exact(x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn int(n: i64) -> f64 {
        n as f64
    }
    fn decimal(text: &str) -> Result<f64, ParseFloatError> {
        text.trim()
            .parse::<f64>()
            .map_err(|_| ParseFloatError { text: text.into() })
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn as_doubles(x: &[f64]) -> Option<&[f64]> {
        Some(x)
    }
    #[inline(always)]
    fn as_doubles_mut(x: &mut [f64]) -> Option<&mut [f64]> {
        Some(x)
    }
    #[inline(always)]
    fn expansion(self) -> Words {
        [self, 0.0, 0.0, 0.0, 0.0, 0.0]
    }
}
