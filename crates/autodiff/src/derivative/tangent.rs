//! [`Tangent`]: a number with its rate of change, or with what rounding makes of it.
//!
//! The recording of ∇H replayed on tangents gives ∇²H·v. The value is computed by the very functions of the
//! float below, so it has every bit of the plain replay. Derivatives at kinks are those of that recording;
//! the rates of selections (sign, the smaller of two) are zero.
//!
//! With sizes in place of rates, and the rounding of each result added, the same rules are those of the
//! running error bound ([`Rounding`]; Higham, Accuracy and Stability of Numerical Algorithms, 2002, section
//! 3.3). It is in the units of the value, to first order, and counts ε for each operation, be it a power or
//! a table; constants are rounded alike at every state, and do not count.

use equip_scalar::{Constant, Float, Outside, Piecewise, Scalar};
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// What is carried beside a value.
pub(crate) trait Rate<T: Float>: Copy + Debug + Send + Sync + 'static {
    /// Of what is fixed.
    fn zero() -> Self;

    /// Of f(x), given f and f′ at the value.
    fn chain(self, f: T, slope: T) -> Self;

    /// Of f(x, y), given f and its partial derivatives at the values.
    fn chain2(self, other: Self, f: T, by_x: T, by_y: T) -> Self;

    /// Of −x, which is exact.
    fn opposite(self) -> Self;

    fn is_zero(self) -> bool;
}

/// The rate of change in one direction.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Change<T>(pub(crate) T);

impl<T: Float> Rate<T> for Change<T> {
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
    fn opposite(self) -> Self {
        self
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self.0 == T::int(0)
    }
}

/// A value, and what is carried beside it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tangent<T, R> {
    pub(crate) value: T,
    pub(crate) rate: R,
}

impl<T: Float, R: Rate<T>> Tangent<T, R> {
    #[inline(always)]
    pub(crate) fn fixed(value: T) -> Self {
        Tangent {
            value,
            rate: R::zero(),
        }
    }

    /// f(x), given f and f′ at the value.
    #[inline(always)]
    fn chain(self, f: T, slope: T) -> Self {
        Tangent {
            value: f,
            rate: self.rate.chain(f, slope),
        }
    }

    /// f(x, y), given f and its partial derivatives at the values.
    #[inline(always)]
    fn chain2(self, other: Self, f: T, by_x: T, by_y: T) -> Self {
        Tangent {
            value: f,
            rate: self.rate.chain2(other.rate, f, by_x, by_y),
        }
    }
}

impl<T: Float, R: Rate<T>> Add for Tangent<T, R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let one = T::int(1);
        self.chain2(other, self.value + other.value, one, one)
    }
}

impl<T: Float, R: Rate<T>> Sub for Tangent<T, R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let one = T::int(1);
        self.chain2(other, self.value - other.value, one, -one)
    }
}

impl<T: Float, R: Rate<T>> Mul for Tangent<T, R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.chain2(other, self.value * other.value, other.value, self.value)
    }
}

impl<T: Float, R: Rate<T>> Div for Tangent<T, R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let f = self.value / other.value;
        let slope = T::int(1) / other.value;
        self.chain2(other, f, slope, -(f * slope))
    }
}

impl<T: Float, R: Rate<T>> Neg for Tangent<T, R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Tangent {
            value: -self.value,
            rate: self.rate.opposite(),
        }
    }
}

macro_rules! functions {
    ($($name:ident: |$x:ident, $f:ident| $slope:expr;)*) => {$(
        #[inline(always)]
        fn $name(x: Self) -> Self {
            let $x = x.value;
            let $f = <T as Scalar>::$name($x);
            x.chain($f, $slope)
        }
    )*};
}

impl<T: Float, R: Rate<T>> Scalar for Tangent<T, R> {
    #[inline(always)]
    fn constant(c: Constant) -> Self {
        Tangent::fixed(c.to())
    }

    #[inline(always)]
    fn powi(x: Self, n: i32) -> Self {
        let slope = match n {
            0 => T::int(0),
            1 => T::int(1),
            2 => x.value + x.value,
            _ => T::int(i64::from(n)) * <T as Scalar>::powi(x.value, n.saturating_sub(1)),
        };
        x.chain(<T as Scalar>::powi(x.value, n), slope)
    }

    #[inline(always)]
    fn powf(x: Self, c: Constant) -> Self {
        let exponent: T = c.to();
        let less_one = Constant::from_expansion((exponent - T::int(1)).expansion());
        let slope = exponent * <T as Scalar>::powf(x.value, less_one);
        x.chain(
            <T as Scalar>::powf(x.value, c),
            Piecewise::where_nonzero(slope, exponent),
        )
    }

    #[inline(always)]
    fn pow(x: Self, y: Self) -> Self {
        let f = <T as Scalar>::pow(x.value, y.value);
        let by_x = y.value * <T as Scalar>::pow(x.value, y.value - T::int(1));
        let by_y = f * <T as Scalar>::ln(x.value);
        let by_x = Piecewise::where_nonzero(by_x, y.value);
        let by_y = Piecewise::where_nonzero(by_y, f);
        // At x = 0 ln x is infinite; an exponent that does not move must not make NaN of it.
        let by_y = if y.rate.is_zero() { T::int(0) } else { by_y };
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
        Tangent {
            value: <T as Scalar>::min(x.value, y.value),
            rate: taken.rate,
        }
    }

    #[inline(always)]
    fn max(x: Self, y: Self) -> Self {
        let taken = if x.value >= y.value { x } else { y };
        Tangent {
            value: <T as Scalar>::max(x.value, y.value),
            rate: taken.rate,
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

impl<T: Float, R: Rate<T>> Piecewise for Tangent<T, R> {
    #[inline(always)]
    fn sign(x: Self) -> Self {
        Tangent::fixed(Piecewise::sign(x.value))
    }

    #[inline(always)]
    fn at_most(x: Self, y: Self) -> Self {
        Tangent::fixed(Piecewise::at_most(x.value, y.value))
    }

    #[inline(always)]
    fn where_nonzero(x: Self, test: Self) -> Self {
        if test.value == T::int(0) {
            Tangent::fixed(T::int(0))
        } else {
            x
        }
    }

    #[inline(always)]
    fn times_slope(rate: Self, slope: Self) -> Self {
        Tangent {
            value: Piecewise::times_slope(rate.value, slope.value),
            ..rate * slope
        }
    }

    /// The slope of c·xᶜ⁻¹ is (c − 1) times it over x, or from the next power where that says nothing.
    #[inline(always)]
    fn powf_slope(x: Self, power: Self, c: Constant) -> Self {
        let f = Piecewise::powf_slope(x.value, power.value, c);
        let factor: T = c.to();
        let less = factor - T::int(1);
        let slope = if f != T::int(0) && Piecewise::is_regular(f) {
            Piecewise::where_nonzero(less * f / x.value, less)
        } else {
            let next = <T as Scalar>::pow(x.value, less - T::int(1));
            Piecewise::where_nonzero(factor * less * next, factor * less)
        };
        x.chain(f, slope)
    }

    #[inline(always)]
    fn is_regular(x: Self) -> bool {
        Piecewise::is_regular(x.value)
    }
}
