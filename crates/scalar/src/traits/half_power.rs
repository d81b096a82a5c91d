//! Powers with half-integer exponents: a root and a few products in place of exp(c ln x).
//!
//! x^(n/2) with n = ±(2k + 1) is xᵏ√x, or 1/(xᵏ√x). All number types use this formula, so their values agree
//! to the last bit. Relative error: k + 2 roundings. Cost: √ and about log₂ k products, with n < 0 a division
//! more; a fifth of that of exp and ln over lanes.
//!
//! Like √, it is NaN at −∞, and preserves the sign of −0 for n = ±1.

use crate::constant::Constant;
use crate::traits::Scalar;
use std::ops::Mul;

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
pub(crate) fn half_power_derivative<S: Scalar>(x: S, power: S, n: i32) -> S {
    let c = S::constant(Constant::double(0.5 * f64::from(n)));
    if n > 0 {
        c * half_power(x, n - 2)
    } else {
        c * power / x
    }
}

/// xⁿ by repeated squares; none for n = 0.
#[inline(always)]
pub(crate) fn by_squares<S: Copy + Mul<Output = S>>(x: S, mut n: u32) -> Option<S> {
    let (mut square, mut power) = (x, None);
    while n > 0 {
        if n & 1 == 1 {
            power = match power {
                Some(power) => Some(power * square),
                None => Some(square),
            };
        }
        n >>= 1;
        if n > 0 {
            square = square * square;
        }
    }
    power
}
