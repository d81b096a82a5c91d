//! [`DoubleDouble`] as [`Scalar`] and [`Float`].

use super::lanes::DoubleDoubles;
use super::number::{DoubleDouble, dd};
use super::words;
use crate::constant::{Constant, Words};
use crate::error::ParseFloatError;
use crate::forward::Forward;
use crate::traits::{Float, Outside, Scalar, scalar_glue};
use std::sync::Arc;

float_glue!([] DoubleDouble);

impl From<DoubleDouble> for Constant {
    fn from(x: DoubleDouble) -> Self {
        Constant::from_expansion(x.expansion())
    }
}

impl Scalar for DoubleDouble {
    scalar_glue!();
    scalar_glue!(; acosh, atanh, erf, erfc);
    #[inline(always)]
    fn outside(f: &Arc<dyn Outside>, orders: [u8; 2], x: [Self; 2]) -> Self {
        let [hi, lo] = f.derivative_in_pairs(orders, x.map(|x| [x.hi, x.lo]));
        DoubleDouble::new(hi, lo)
    }
}

impl Float for DoubleDouble {
    const NAME: &'static str = "dd";
    const MANTISSA_BITS: u32 = 106;
    const ROUND_TRIP_DIGITS: usize = 34;
    const EPSILON: Self = DoubleDouble::EPSILON;
    const MAX: Self = DoubleDouble::MAX;
    const MIN_POSITIVE: Self = DoubleDouble::MIN_POSITIVE;
    const INFINITY: Self = DoubleDouble::INFINITY;
    const NAN: Self = DoubleDouble::NAN;

    const IS_DOUBLE_DOUBLE: bool = true;
    const WIDTH: usize = 8;
    type Pack<const N: usize> = DoubleDoubles<N>;
    type Forward<const N: usize> = Forward<DoubleDouble, N>;

    #[inline(always)]
    fn exact(x: f64) -> Self {
        x.into()
    }
    #[inline(always)]
    fn int(n: i64) -> Self {
        DoubleDouble::from_i64(n)
    }
    fn decimal(text: &str) -> Result<Self, ParseFloatError> {
        text.trim().parse()
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.hi
    }
    #[inline(always)]
    fn expansion(self) -> Words {
        DoubleDouble::expansion(self)
    }
    fn from_expansion(parts: Words) -> Self {
        let [a, b, c, d, ..] = parts;
        if c == 0.0 && d == 0.0 {
            Self::new(a, b)
        } else {
            Self::new(a, b) + Self::new(c, d)
        }
    }
    #[inline(always)]
    fn is_nan(self) -> bool {
        DoubleDouble::is_nan(self)
    }

    /// (s, e) with s + e = a + b exactly and |e| below 2⁻¹⁰⁴ |s|. (Knuth's formula in double-double
    /// arithmetic would not be exact.)
    #[inline]
    fn two_sum(a: Self, b: Self) -> (Self, Self) {
        let ((s, m), (p, q)) = words::distilled(a.words(), b.words());
        if m.is_nan() || q.is_nan() {
            return (a + b, Self::ZERO);
        }
        (dd(s, m), dd(p, q))
    }
}
