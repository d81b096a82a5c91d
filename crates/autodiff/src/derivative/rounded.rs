//! [`Rounded`]: a number with its running error bound.
//!
//! The trace of ∇H replayed on these numbers gives the running error bound of each component (Higham,
//! Accuracy and Stability of Numerical Algorithms, 2002, section 3.3), to first order, in the units of the
//! component. Each operation counts ε, including powers and tables. Exact operations do not count: changes of
//! sign, products with powers of two, 2x as x + x, x + 0, selections, arithmetic on small integers. Constants
//! have the same rounding at every state, and do not count. The functions of the underlying float type
//! compute the value, so it agrees bit for bit with the plain replay.

use super::exact::is_power_of_two;
use equip_scalar::{Constant, Float, Outside, Piecewise, Scalar};
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

    /// f(x), given f and f′ at the value.
    #[inline(always)]
    fn chain(self, f: T, derivative: T) -> Self {
        Rounded {
            value: f,
            error: (derivative * self.error).abs() + T::EPSILON * f.abs(),
        }
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
    ($($name:ident: |$x:ident, $f:ident| $derivative:expr;)*) => {$(
        #[inline(always)]
        fn $name(x: Self) -> Self {
            let $x = x.value;
            let $f = <T as Scalar>::$name($x);
            x.chain($f, $derivative)
        }
    )*};
}

impl<T: Float> Scalar for Rounded<T> {
    #[inline(always)]
    fn constant(c: Constant) -> Self {
        Rounded::fixed(c.to())
    }

    #[inline(always)]
    fn powi(x: Self, n: i32) -> Self {
        let derivative = match n {
            0 => T::int(0),
            1 => T::int(1),
            2 => x.value + x.value,
            _ => T::int(i64::from(n)) * <T as Scalar>::powi(x.value, n.saturating_sub(1)),
        };
        x.chain(<T as Scalar>::powi(x.value, n), derivative)
    }

    #[inline(always)]
    fn powf(x: Self, c: Constant) -> Self {
        let exponent: T = c.to();
        let less_one = Constant::from_expansion((exponent - T::int(1)).expansion());
        let derivative = exponent * <T as Scalar>::powf(x.value, less_one);
        x.chain(
            <T as Scalar>::powf(x.value, c),
            Piecewise::where_nonzero(derivative, exponent),
        )
    }

    #[inline(always)]
    fn pow(x: Self, y: Self) -> Self {
        let f = <T as Scalar>::pow(x.value, y.value);
        let by_x = y.value * <T as Scalar>::pow(x.value, y.value - T::int(1));
        let by_y = f * <T as Scalar>::ln(x.value);
        let by_x = Piecewise::where_nonzero(by_x, y.value);
        let by_y = Piecewise::where_nonzero(by_y, f);
        // ln x is infinite at x = 0. With a constant exponent it must not cause NaN.
        let by_y = if y.error == T::int(0) {
            T::int(0)
        } else {
            by_y
        };
        x.chain2(y, f, by_x, by_y)
    }

    #[inline(always)]
    fn atan2(y: Self, x: Self) -> Self {
        let r = <T as Scalar>::hypot(x.value, y.value);
        let f = <T as Scalar>::atan2(y.value, x.value);
        y.chain2(x, f, x.value / r / r, -(y.value / r / r))
    }

    #[inline(always)]
    fn hypot(x: Self, y: Self) -> Self {
        let f = <T as Scalar>::hypot(x.value, y.value);
        let [by_x, by_y] = [x.value, y.value].map(|z| Piecewise::where_nonzero(z / f, f));
        x.chain2(y, f, by_x, by_y)
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
    fn signum(x: Self) -> Self {
        Piecewise::sign(x)
    }

    #[inline(always)]
    fn select(test: Self, at_least_zero: Self, below: Self) -> Self {
        Piecewise::by_sign(test, at_least_zero, below)
    }

    #[inline(always)]
    fn outside(f: &Arc<dyn Outside>, [i, j]: [u8; 2], [x, y]: [Self; 2]) -> Self {
        let derivative = |i, j| <T as Scalar>::outside(f, [i, j], [x.value, y.value]);
        let (value, by_x) = (derivative(i, j), derivative(i + 1, j));
        if f.variables() == 1 {
            x.chain(value, by_x)
        } else {
            x.chain2(y, value, by_x, derivative(i, j + 1))
        }
    }

    functions! {
        recip: |_x, f| -(f * f);
        sqrt: |_x, f| T::int(1) / (f + f);
        exp: |_x, f| f;
        ln: |x, _f| T::int(1) / x;
        exp_m1: |x, _f| <T as Scalar>::exp(x);
        ln_1p: |x, _f| T::int(1) / (T::int(1) + x);
        sin: |x, _f| <T as Scalar>::cos(x);
        cos: |x, _f| -<T as Scalar>::sin(x);
        tan: |_x, f| T::int(1) + f * f;
        asin: |x, _f| <T as Scalar>::recip(<T as Scalar>::sqrt((T::int(1) - x) * (T::int(1) + x)));
        acos: |x, _f| -<T as Scalar>::recip(<T as Scalar>::sqrt((T::int(1) - x) * (T::int(1) + x)));
        atan: |x, _f| T::int(1) / (T::int(1) + x * x);
        sinh: |x, _f| <T as Scalar>::cosh(x);
        cosh: |x, _f| <T as Scalar>::sinh(x);
        tanh: |x, _f| {
            let u = <T as Scalar>::exp(-<T as Scalar>::abs(x));
            let sech = (u + u) / (T::int(1) + u * u);
            sech * sech
        };
        cbrt: |_x, f| <T as Scalar>::recip(T::int(3) * f * f);
        exp2: |_x, f| T::ln_2() * f;
        asinh: |x, _f| <T as Scalar>::recip(<T as Scalar>::hypot(x, T::int(1)));
        acosh: |x, _f| <T as Scalar>::recip(
            <T as Scalar>::sqrt(x - T::int(1)) * <T as Scalar>::sqrt(x + T::int(1))
        );
        atanh: |x, _f| <T as Scalar>::recip((T::int(1) - x) * (T::int(1) + x));
        erf: |x, _f| T::frac_2_sqrt_pi() * <T as Scalar>::exp(-(x * x));
        erfc: |x, _f| -(T::frac_2_sqrt_pi() * <T as Scalar>::exp(-(x * x)));
        abs: |x, _f| Piecewise::sign(x);
    }
}

impl<T: Float> Piecewise for Rounded<T> {
    #[inline(always)]
    fn sign(x: Self) -> Self {
        Rounded::fixed(Piecewise::sign(x.value))
    }

    #[inline(always)]
    fn at_most(x: Self, y: Self) -> Self {
        Rounded::fixed(Piecewise::at_most(x.value, y.value))
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
    fn times_derivative(rate: Self, derivative: Self) -> Self {
        Rounded {
            value: Piecewise::times_derivative(rate.value, derivative.value),
            ..rate * derivative
        }
    }

    /// The derivative of c·xᶜ⁻¹ is (c − 1)/x times this function. If that expression is undefined, it is
    /// computed from the next power.
    #[inline(always)]
    fn powf_derivative(x: Self, power: Self, c: Constant) -> Self {
        let f = Piecewise::powf_derivative(x.value, power.value, c);
        let factor: T = c.to();
        let less = factor - T::int(1);
        let derivative = if f != T::int(0) && Piecewise::is_regular(f) {
            Piecewise::where_nonzero(less * f / x.value, less)
        } else {
            let next = <T as Scalar>::pow(x.value, less - T::int(1));
            Piecewise::where_nonzero(factor * less * next, factor * less)
        };
        x.chain(f, derivative)
    }

    #[inline(always)]
    fn is_regular(x: Self) -> bool {
        Piecewise::is_regular(x.value)
    }
}
