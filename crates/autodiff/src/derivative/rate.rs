//! [`Rate`]: what a tangent carries, a rate of change or what rounding makes of a number.

use equip_scalar::Float;
use std::fmt::Debug;

/// What is carried beside a value.
pub(crate) trait Rate<T: Float>: Copy + Debug + Send + Sync + 'static {
    /// Whether operations that are rounded add to it.
    const ROUNDS: bool;

    /// Of what is fixed.
    fn zero() -> Self;

    /// Of f(x), given f and f′ at the value.
    fn chain(self, f: T, slope: T) -> Self;

    /// Of f(x, y), given f and its partial derivatives at the values.
    fn chain2(self, other: Self, f: T, by_x: T, by_y: T) -> Self;

    /// Of a sum, a difference or a product that is not rounded, given its partial derivatives.
    fn exact(self, other: Self, by_x: T, by_y: T) -> Self;

    /// Of −x, which is exact.
    fn opposite(self) -> Self;

    fn is_zero(self) -> bool;
}

/// The rate of change in one direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Change<T>(pub(crate) T);

impl<T: Float> Rate<T> for Change<T> {
    const ROUNDS: bool = false;

    #[inline(always)]
    fn zero() -> Self {
        Change(T::int(0))
    }

    #[inline(always)]
    fn chain(self, _: T, slope: T) -> Self {
        Change(slope * self.0)
    }

    #[inline(always)]
    fn chain2(self, other: Self, _: T, by_x: T, by_y: T) -> Self {
        Change(by_x * self.0 + by_y * other.0)
    }

    #[inline(always)]
    fn exact(self, other: Self, by_x: T, by_y: T) -> Self {
        self.chain2(other, T::int(0), by_x, by_y)
    }

    #[inline(always)]
    fn opposite(self) -> Self {
        Change(-self.0)
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self.0 == T::int(0)
    }
}

/// How far a number may be off, as its operands may and it is rounded itself: to ε, each operation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rounding<T>(pub(crate) T);

impl<T: Float> Rate<T> for Rounding<T> {
    const ROUNDS: bool = true;

    #[inline(always)]
    fn zero() -> Self {
        Rounding(T::int(0))
    }

    #[inline(always)]
    fn chain(self, f: T, slope: T) -> Self {
        Rounding((slope * self.0).abs() + T::EPSILON * f.abs())
    }

    #[inline(always)]
    fn chain2(self, other: Self, f: T, by_x: T, by_y: T) -> Self {
        Rounding((by_x * self.0).abs() + (by_y * other.0).abs() + T::EPSILON * f.abs())
    }

    #[inline(always)]
    fn exact(self, other: Self, by_x: T, by_y: T) -> Self {
        Rounding((by_x * self.0).abs() + (by_y * other.0).abs())
    }

    #[inline(always)]
    fn opposite(self) -> Self {
        self
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self.0 == T::int(0)
    }
}
