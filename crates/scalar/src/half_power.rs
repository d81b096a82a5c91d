//! Powers with half-integer exponents: a root and a few products in place of exp(c ln x).
//!
//! x^(n/2) with n = ±(2k + 1) is xᵏ√x, or 1/(xᵏ√x). Every number takes this way, so the value is the same on
//! all routes to the last bit. Relative error: k + 2 roundings. Cost: √ and about log₂ k products, with n < 0
//! a division more; a fifth of that of exp and ln over lanes.
//!
//! As √, it is NaN at −∞, and keeps the sign of −0 where n = ±1.

use crate::constant::{Constant, Written};
use crate::traits::{Float, Scalar};

/// Largest |n| of x^(n/2): beyond, rounding adds up, and exp(c ln x) is as good.
const LARGEST: i32 = 15;

impl Constant {
    /// The odd n for which it is n/2 in the float type `T`, with |n| ≤ 15.
    #[inline(always)]
    pub(crate) fn halves<T: Float>(self) -> Option<i32> {
        let double = self.to_double();
        let n = (2.0 * double) as i32;
        let is_half = n & 1 == 1 && n.abs() <= LARGEST && f64::from(n) == 2.0 * double;
        (is_half && (T::IS_DOUBLE || self.to::<T>() == T::exact(double))).then_some(n)
    }

    /// The odd n for which it is n/2 in every float type, with |n| ≤ 15.
    #[doc(hidden)]
    pub fn exact_halves(self) -> Option<i32> {
        let n = self.halves::<f64>()?;
        let is_exact = match self.written() {
            Written::Double(_) => true,
            Written::Ratio(above, below) => {
                2 * i128::from(above) == i128::from(n) * i128::from(below)
            }
            Written::Extended(parts) => parts[1..] == [0.0; 3],
            Written::Decimal(_) => false,
        };
        is_exact.then_some(n)
    }
}

/// x^(n/2) for an odd n.
#[inline(always)]
pub(crate) fn half_power<S: Scalar>(x: S, n: i32) -> S {
    let root = S::sqrt(x);
    let power = match n.unsigned_abs() / 2 {
        0 => root,
        1 => x * root,
        2 => (x * x) * root,
        k => S::powi(x, k as i32) * root,
    };
    if n < 0 {
        S::constant(Constant::double(1.0)) / power
    } else {
        power
    }
}

/// The derivative of `power` = x^(n/2).
#[inline(always)]
pub(crate) fn half_power_slope<S: Scalar>(x: S, power: S, n: i32) -> S {
    let c = S::constant(Constant::double(0.5 * f64::from(n)));
    if n > 0 {
        c * half_power(x, n - 2)
    } else {
        c * power / x
    }
}
