//! Numbers that carry their derivatives.

use super::piecewise::Piecewise;

/// A number that carries N first derivatives.
pub trait FirstOrder<T, const N: usize>: Piecewise {
    /// With this value and these derivatives.
    fn with_gradient(x: T, gradient: [T; N]) -> Self;
    /// The independent variable number `index`, with value `x`.
    fn variable(x: T, index: usize) -> Self;
    /// The value.
    fn value(&self) -> T;
    /// The N first derivatives.
    fn gradient(&self) -> [T; N];
}

/// A number that carries N first and N×N second derivatives.
pub trait SecondOrder<T, const N: usize>: FirstOrder<T, N> {
    /// The second derivatives, `[i][j]` = ∂²/∂x_i∂x_j.
    fn hessian(&self) -> [[T; N]; N];
}
