//! [`Scalar`]: the number types in which an energy is evaluated.

use super::outside::Outside;
use crate::constant::Constant;
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// Arithmetic and elementary functions, without operations that could make a program branch on the state.
///
/// Floats, dual numbers and the tracing variable implement it. All functions are associated functions without
/// a receiver; in energies they are methods of [`Num`](crate::Num). Special cases (NaN, infinities, domains)
/// follow `f64`: the square root of a negative number is NaN, and so on.
pub trait Scalar:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The constant `c`, read as exactly as this type can.
    fn constant(c: Constant) -> Self;
    /// 1/x.
    fn recip(x: Self) -> Self;
    /// √x.
    fn sqrt(x: Self) -> Self;
    /// ∛x, of negative numbers too.
    fn cbrt(x: Self) -> Self;
    /// xⁿ for an integer n.
    fn powi(x: Self, n: i32) -> Self;
    /// xᶜ for a constant exponent, by √x where it is a half-integer up to 15/2; the derivative at x = 0 is
    /// that of the power, not of exp(c ln x).
    fn powf(x: Self, c: Constant) -> Self;
    /// xʸ = exp(y ln x) for a variable exponent, x > 0.
    fn pow(x: Self, y: Self) -> Self;
    /// eˣ.
    fn exp(x: Self) -> Self;
    /// 2ˣ; exact for integers.
    fn exp2(x: Self) -> Self;
    /// Natural logarithm.
    fn ln(x: Self) -> Self;
    /// eˣ − 1, accurate near 0.
    fn exp_m1(x: Self) -> Self;
    /// ln(1 + x), accurate near 0.
    fn ln_1p(x: Self) -> Self;
    /// Sine of x in radians.
    fn sin(x: Self) -> Self;
    /// Cosine of x in radians.
    fn cos(x: Self) -> Self;
    /// Tangent of x in radians.
    fn tan(x: Self) -> Self;
    /// Inverse sine, in [−π/2, π/2].
    fn asin(x: Self) -> Self;
    /// Inverse cosine, in [0, π].
    fn acos(x: Self) -> Self;
    /// Inverse tangent, in [−π/2, π/2].
    fn atan(x: Self) -> Self;
    /// Angle of the point (x, y), in [−π, π].
    fn atan2(y: Self, x: Self) -> Self;
    /// Hyperbolic sine.
    fn sinh(x: Self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(x: Self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(x: Self) -> Self;
    /// Inverse hyperbolic sine.
    fn asinh(x: Self) -> Self;
    /// Inverse hyperbolic cosine; NaN below 1.
    fn acosh(x: Self) -> Self;
    /// Inverse hyperbolic tangent; ±∞ at ±1, NaN outside.
    fn atanh(x: Self) -> Self;
    /// Error function 2/√π ∫₀ˣ exp(−t²) dt.
    fn erf(x: Self) -> Self;
    /// 1 − erf x, with full relative precision where that is small.
    fn erfc(x: Self) -> Self;
    /// √(x² + y²) without undue overflow.
    fn hypot(x: Self, y: Self) -> Self;
    /// |x|; its derivative is the sign of x.
    fn abs(x: Self) -> Self;
    /// The smaller of two; derivatives are those of the one taken.
    fn min(x: Self, y: Self) -> Self;
    /// The larger of two; derivatives are those of the one taken.
    fn max(x: Self, y: Self) -> Self;
    /// −1, 0 or 1 by the sign of x; x itself where it is ±0 or NaN. Its derivative is 0.
    fn signum(x: Self) -> Self;
    /// One number where `test` ≥ 0, the other elsewhere; derivatives are those of the one taken.
    #[inline(always)]
    fn select(test: Self, at_least_zero: Self, below: Self) -> Self {
        let [zero, one] = [0.0, 1.0].map(|x| Self::constant(Constant::double(x)));
        let is_taken = Self::at_most(zero, test);
        let other = Self::where_nonzero(below, one - is_taken);
        Self::where_nonzero(at_least_zero, is_taken) + other
    }
    /// 1 where x ≤ y, 0 elsewhere. Its derivative is 0.
    fn at_most(x: Self, y: Self) -> Self;
    /// x where `test` is not zero, 0 where it is, whatever x is there.
    fn where_nonzero(x: Self, test: Self) -> Self;
    /// The derivative c·xᶜ⁻¹ of `power` = xᶜ for a constant exponent: from the power where that is neither 0
    /// nor infinite. Half-integer exponents up to 15/2 are those of a root. A factor 0 is 0 also before an
    /// infinite power.
    fn powf_derivative(x: Self, power: Self, c: Constant) -> Self;
    /// The derivative of these orders of a function at x; one of one variable has the same number twice.
    fn outside(f: &Arc<dyn Outside>, orders: [u8; 2], x: [Self; 2]) -> Self;
}
