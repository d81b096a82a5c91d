//! Numbers that carry their derivatives.

use super::scalar::Scalar;

/// A number that carries N first derivatives.
pub trait FirstOrder<T, const N: usize>: Scalar {
    /// With this value and these derivatives.
    fn with_gradient(x: T, gradient: [T; N]) -> Self;
    /// The independent variable number `index`, with value `x`.
    fn variable(x: T, index: usize) -> Self;
    /// The value.
    fn value(&self) -> T;
    /// The N first derivatives.
    fn gradient(&self) -> [T; N];
}
