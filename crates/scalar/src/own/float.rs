//! [`Own`] as [`Scalar`] and [`Float`].

use super::functions::{sum, words};
use super::{Arithmetic, Own};
use crate::constant::{Constant, Words};
use crate::error::ParseFloatError;
use crate::forward::Forward;
use crate::kernels::Lanes;
use crate::traits::{Float, Outside, Scalar, scalar_glue};
use num_dual::DualNumFloat;
use std::sync::Arc;

float_glue!([A: Arithmetic] Own<A>);

impl<A: Arithmetic> From<Own<A>> for Constant {
    fn from(x: Own<A>) -> Self {
        Constant::from_expansion(x.expansion())
    }
}

/// num-dual's constants need a constant function from `f64`. None of its functions that use them is called
/// here.
impl<A: Arithmetic> DualNumFloat for Own<A> {
    const THIRD: Self = Own(A::NAN);
    const HALF: Self = Own(A::NAN);
    const TWO: Self = Own(A::NAN);
    const THREE: Self = Own(A::NAN);
    const FOUR: Self = Own(A::NAN);
    const SIX: Self = Own(A::NAN);
    const TEN: Self = Own(A::NAN);
    const FIFTEEN: Self = Own(A::NAN);
}

impl<A: Arithmetic> Scalar for Own<A> {
    scalar_glue!();
    scalar_glue!(; acosh, atanh, erf, erfc);
    /// To 31 digits.
    fn outside(f: &Arc<dyn Outside>, orders: [u8; 2], x: [Self; 2]) -> Self {
        let pairs = x.map(|x| {
            let [hi, lo, ..] = x.expansion();
            [hi, lo]
        });
        let [hi, lo] = f.derivative_in_pairs(orders, pairs);
        Self::small(hi) + Self::small(lo)
    }
}

impl<A: Arithmetic> Float for Own<A> {
    const NAME: &'static str = A::NAME;
    const MANTISSA_BITS: u32 = A::MANTISSA_BITS;
    const ROUND_TRIP_DIGITS: usize = (A::MANTISSA_BITS * 30_103).div_ceil(100_000) as usize + 1;
    const EPSILON: Self = Self::EPSILON;
    const MAX: Self = Self::MAX;
    const MIN_POSITIVE: Self = Self::MIN_POSITIVE;
    const INFINITY: Self = Self::INFINITY;
    const NAN: Self = Self::NAN;

    const WIDTH: usize = 1;
    type Pack<const N: usize> = Lanes<N, Self>;
    type Forward<const N: usize> = Forward<Self, N>;

    #[inline(always)]
    fn exact(x: f64) -> Self {
        Self::small(x)
    }
    #[inline(always)]
    fn int(n: i64) -> Self {
        if n.unsigned_abs() < 1 << 53 {
            Self::small(n as f64)
        } else {
            Self::from_i64(n)
        }
    }
    fn decimal(text: &str) -> Result<Self, ParseFloatError> {
        text.trim().parse()
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.hi()
    }
    fn expansion(self) -> Words {
        words(self)
    }
    fn from_expansion(parts: Words) -> Self {
        sum(&parts)
    }
}
