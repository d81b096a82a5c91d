//! [`Rounded`]: a number with its running error bound.
//!
//! The trace of ∇H replayed on these numbers gives the running error bound of each component (Higham,
//! Accuracy and Stability of Numerical Algorithms, 2002, section 3.3), to first order, in the units of the
//! component. Each operation counts ε, including powers and tables. Exact operations do not count: changes of
//! sign, products with powers of two, 2x as x + x, x + 0, selections, arithmetic on small integers. Constants
//! have the same rounding at every state, and do not count. Functions and their derivatives are those of dual
//! numbers.

use super::exact::is_power_of_two;
use equip_scalar::{Constant, FirstOrder, Float, Outside, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// A value, and the bound of its error due to its operands and its own rounding.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rounded<T> {
    pub(crate) value: T,
    pub(crate) error: T,
}

impl<T: Float> Rounded<T> {
    #[inline(always)]
    pub(crate) fn fixed(value: T) -> Self {
        Rounded {
            value,
            error: T::int(0),
        }
    }

    /// f(x): dual numbers propagate the error of x, and f is rounded.
    #[inline(always)]
    fn through(self, f: impl FnOnce(T::Forward<1>) -> T::Forward<1>) -> Self {
        let f = f(self.dual(self.error));
        Rounded {
            value: f.value(),
            error: f.gradient()[0].abs() + T::EPSILON * f.value().abs(),
        }
    }

    /// f(x, y): dual numbers propagate the error of one after the other, and f is rounded.
    #[inline(always)]
    fn through_two(
        self,
        other: Self,
        f: impl Fn(T::Forward<1>, T::Forward<1>) -> T::Forward<1>,
    ) -> Self {
        let zero = T::int(0);
        let by_x = self.through(|x| f(x, other.dual(zero)));
        let by_y = f(self.dual(zero), other.dual(other.error));
        Rounded {
            error: by_x.error + by_y.gradient()[0].abs(),
            ..by_x
        }
    }

    #[inline(always)]
    fn dual(self, derivative: T) -> T::Forward<1> {
        T::Forward::with_gradient(self.value, [derivative])
    }

    /// f(x, y), given f and its partial derivatives at the values.
    #[inline(always)]
    fn chain2(self, other: Self, f: T, by_x: T, by_y: T) -> Self {
        let exact = self.exactly(other, f, by_x, by_y);
        Rounded {
            error: exact.error + T::EPSILON * f.abs(),
            ..exact
        }
    }

    /// f(x, y) for an operation that is not rounded.
    #[inline(always)]
    fn exactly(self, other: Self, f: T, by_x: T, by_y: T) -> Self {
        Rounded {
            value: f,
            error: (by_x * self.error).abs() + (by_y * other.error).abs(),
        }
    }

    /// The sum or difference f. `doubles` if both operands have the same value.
    #[inline(always)]
    fn linear(self, other: Self, f: T, [by_x, by_y]: [T; 2], doubles: bool) -> Self {
        let is_exact = doubles
            || self.is_none()
            || other.is_none()
            || numbers(self, other).is_some_and(|[x, y]| is_sum(f, x, by_y.to_f64() * y));
        match is_exact {
            true => self.exactly(other, f, by_x, by_y),
            false => self.chain2(other, f, by_x, by_y),
        }
    }

    /// Whether the number is 0 exactly, and not by cancellation.
    #[inline(always)]
    fn is_none(self) -> bool {
        self.value == T::int(0) && self.error == T::int(0)
    }

    /// Whether products with this number are exact: it is 0 or ± a power of two.
    #[inline(always)]
    fn scales(self) -> bool {
        let [x, rest, ..] = self.value.expansion();
        self.error == T::int(0) && rest == 0.0 && (x == 0.0 || is_power_of_two(x))
    }
}

/// The values if both are doubles at every state, such as counts.
#[inline(always)]
fn numbers<T: Float>(x: Rounded<T>, y: Rounded<T>) -> Option<[f64; 2]> {
    let is_fixed = x.error == T::int(0) && y.error == T::int(0);
    let [[x, x_rest, ..], [y, y_rest, ..]] = [x, y].map(|x| x.value.expansion());
    (is_fixed && x_rest == 0.0 && y_rest == 0.0).then_some([x, y])
}

/// Whether f = x + y exactly, by the error of the sum (Knuth 1969).
fn is_sum<T: Float>(f: T, x: f64, y: f64) -> bool {
    let [high, low, ..] = f.expansion();
    let sum = x + y;
    let from_y = sum - x;
    high == sum && low == (x - (sum - from_y)) + (y - from_y)
}

/// Whether f = xy exactly, by the error of the product.
fn is_product<T: Float>(f: T, x: f64, y: f64) -> bool {
    let [high, low, ..] = f.expansion();
    high == x * y && low == x.mul_add(y, -high)
}

impl<T: Float> Add for Rounded<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let one = T::int(1);
        let f = self.value + other.value;
        self.linear(other, f, [one, one], self.value == other.value)
    }
}

impl<T: Float> Sub for Rounded<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let one = T::int(1);
        let f = self.value - other.value;
        self.linear(other, f, [one, -one], self.value == -other.value)
    }
}

impl<T: Float> Mul for Rounded<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let f = self.value * other.value;
        let (by_x, by_y) = (other.value, self.value);
        let is_exact = || {
            self.scales()
                || other.scales()
                || numbers(self, other).is_some_and(|[x, y]| is_product(f, x, y))
        };
        match is_exact() {
            true => self.exactly(other, f, by_x, by_y),
            false => self.chain2(other, f, by_x, by_y),
        }
    }
}

impl<T: Float> Div for Rounded<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let f = self.value / other.value;
        let derivative = T::int(1) / other.value;
        match other.scales() {
            true => self.exactly(other, f, derivative, -(f * derivative)),
            false => self.chain2(other, f, derivative, -(f * derivative)),
        }
    }
}

impl<T: Float> Neg for Rounded<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Rounded {
            value: -self.value,
            error: self.error,
        }
    }
}

macro_rules! functions {
    ($($f:ident),*; $($g:ident),*) => {
        $(
            #[inline(always)]
            fn $f(x: Self) -> Self {
                x.through(Scalar::$f)
            }
        )*
        $(
            #[inline(always)]
            fn $g(x: Self, y: Self) -> Self {
                x.through_two(y, Scalar::$g)
            }
        )*
    };
}

impl<T: Float> Scalar for Rounded<T> {
    #[inline(always)]
    fn constant(c: Constant) -> Self {
        Rounded::fixed(c.to())
    }
    #[inline(always)]
    fn powi(x: Self, n: i32) -> Self {
        x.through(|x| Scalar::powi(x, n))
    }
    #[inline(always)]
    fn powf(x: Self, c: Constant) -> Self {
        x.through(|x| Scalar::powf(x, c))
    }
    #[inline(always)]
    fn min(x: Self, y: Self) -> Self {
        let taken = if x.value <= y.value { x } else { y };
        Rounded {
            value: <T as Scalar>::min(x.value, y.value),
            error: taken.error,
        }
    }

    #[inline(always)]
    fn max(x: Self, y: Self) -> Self {
        let taken = if x.value >= y.value { x } else { y };
        Rounded {
            value: <T as Scalar>::max(x.value, y.value),
            error: taken.error,
        }
    }

    #[inline(always)]
    fn outside(f: &Arc<dyn Outside>, orders: [u8; 2], [x, y]: [Self; 2]) -> Self {
        let function = |x, y| Scalar::outside(f, orders, [x, y]);
        match f.variables() {
            1 => x.through(|x| function(x, x)),
            _ => x.through_two(y, function),
        }
    }
    functions!(
        recip, sqrt, cbrt, exp, exp2, ln, exp_m1, ln_1p, sin, cos, tan, asin, acos, atan, sinh,
        cosh, tanh, asinh, acosh, atanh, erf, erfc, abs; pow, atan2, hypot
    );
    #[inline(always)]
    fn signum(x: Self) -> Self {
        Rounded::fixed(Scalar::signum(x.value))
    }

    #[inline(always)]
    fn at_most(x: Self, y: Self) -> Self {
        Rounded::fixed(Scalar::at_most(x.value, y.value))
    }

    #[inline(always)]
    fn where_nonzero(x: Self, test: Self) -> Self {
        if test.value == T::int(0) {
            Rounded::fixed(T::int(0))
        } else {
            x
        }
    }
    #[inline(always)]
    fn powf_derivative(x: Self, power: Self, c: Constant) -> Self {
        x.through(|x| Scalar::powf_derivative(x, power.dual(T::int(0)), c))
    }
}
