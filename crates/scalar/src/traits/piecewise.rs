//! [`Piecewise`]: what the derivatives of |x|, min, max, hypot and xʸ need beyond arithmetic.

use super::scalar::Scalar;
use crate::constant::Constant;

/// A [`Scalar`] with the selections that derivatives of piecewise functions are made of.
///
/// Selections, not comparisons: a lane or dual number answers with a number, and its derivative is zero.
/// Every [`Float`](crate::Float) has them.
///
/// ```
/// use equip_scalar::Piecewise;
/// assert_eq!([-3.0, 0.0, 3.0].map(Piecewise::sign), [-1.0, 0.0, 1.0]);
/// assert_eq!(Piecewise::at_most(1.0, 1.0), 1.0);
/// assert_eq!(Piecewise::where_nonzero(0.0 / 0.0, 0.0), 0.0);
/// ```
pub trait Piecewise: Scalar {
    /// −1, 0 or 1 by the sign of x; x itself where it is ±0 or NaN.
    fn sign(x: Self) -> Self;
    /// 1 where x ≤ y, 0 elsewhere.
    fn at_most(x: Self, y: Self) -> Self;
    /// x where `test` is not zero, 0 where it is, whatever x is there.
    fn where_nonzero(x: Self, test: Self) -> Self;
    /// One number where `test` ≥ 0, the other elsewhere, and 0 in place of −0.
    #[inline(always)]
    fn by_sign(test: Self, at_least_zero: Self, below: Self) -> Self {
        let [zero, one] = [0.0, 1.0].map(|x| Self::constant(Constant::double(x)));
        let is_taken = Self::at_most(zero, test);
        let other = Self::where_nonzero(below, one - is_taken);
        Self::where_nonzero(at_least_zero, is_taken) + other
    }
    /// rate·slope, but a rate of 0 remains 0 where the slope is infinite or NaN: √(x² + y²) at a fixed
    /// origin.
    fn times_derivative(rate: Self, derivative: Self) -> Self;
    /// The derivative c·xᶜ⁻¹ of `power` = xᶜ for a constant exponent: from the power where that is neither 0
    /// nor infinite. Half-integer exponents up to 15/2 are those of a root. A factor 0 is 0 also before an
    /// infinite power.
    fn powf_derivative(x: Self, power: Self, c: Constant) -> Self;
    /// Whether every number in it is finite. It may decide how something is computed, never what.
    fn is_regular(x: Self) -> bool;
}
