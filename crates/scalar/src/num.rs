//! [`Num`]: the type of the numbers in a user's energy.

use crate::constant::Constant;
use crate::double_double::DoubleDouble;
use crate::traits::Scalar;
use std::iter::{Product, Sum};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number of any kind: a float, a dual number, or a variable that is being traced.
///
/// It has every operation of [`Scalar`] as a method, and operators with `f64`, `i32`, [`Constant`] and
/// [`DoubleDouble`] on either side. It has no comparison and no conversion to `f64`, because an energy must
/// not branch on the state. Use [`min`](Self::min), [`max`](Self::max), [`abs`](Self::abs),
/// [`clamp`](Self::clamp) and [`select`](Self::select) for piecewise functions.
///
/// The wrapper costs nothing.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub struct Num<S>(pub S);

macro_rules! methods {
    ($($(#[$doc:meta])* $name:ident),*) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub fn $name(self) -> Self {
            Num(S::$name(self.0))
        }
    )*};
}

impl<S: Scalar> Num<S> {
    methods!(
        /// 1/x.
        recip,
        /// √x.
        sqrt,
        /// eˣ.
        exp,
        /// Natural logarithm.
        ln,
        /// eˣ − 1.
        exp_m1,
        /// ln(1 + x).
        ln_1p,
        /// Sine (radians).
        sin,
        /// Cosine (radians).
        cos,
        /// Tangent (radians).
        tan,
        /// Inverse sine.
        asin,
        /// Inverse cosine.
        acos,
        /// Inverse tangent.
        atan,
        /// Hyperbolic sine.
        sinh,
        /// Hyperbolic cosine.
        cosh,
        /// Hyperbolic tangent.
        tanh,
        /// |x|.
        abs
    );

    methods!(
        /// ∛x, of negative numbers too; its derivative is ∞ at 0.
        cbrt,
        /// 2ˣ.
        exp2,
        /// Inverse hyperbolic sine.
        asinh,
        /// Inverse hyperbolic cosine; NaN below 1.
        acosh,
        /// Inverse hyperbolic tangent; NaN outside [−1, 1].
        atanh,
        /// Error function 2/√π ∫₀ˣ exp(−t²) dt.
        erf,
        /// 1 − erf x, with full relative precision where that is small.
        erfc,
        /// −1, 0 or 1 by the sign of x; its derivative is 0.
        signum
    );

    /// Logarithm to base 10: ln x/ln 10.
    #[inline(always)]
    pub fn log10(self) -> Self {
        self.ln() * DoubleDouble::LOG10_E
    }

    /// The nearest number in [low, high]. Its derivative is 0 outside.
    #[inline(always)]
    pub fn clamp(self, low: impl Into<Self>, high: impl Into<Self>) -> Self {
        self.max(low).min(high)
    }

    /// `at_least_zero` if this number is ≥ 0, otherwise `below` (also for NaN): `(q[0] - 1.0).select(0.0,
    /// well)`.
    ///
    /// Both arguments are evaluated at every state, so both must have finite values and derivatives at every
    /// state. If an argument is not defined everywhere, bound its own argument: `x.select(x.max(0).sqrt(),
    /// 0)` has the derivative NaN for x < 0, `x.select(x.max(1e-9).sqrt(), 0)` has not.
    ///
    /// ```
    /// use equip_scalar::Num;
    /// let wall = |x: f64| Num(x).select(Num(x).powi(4), 0).0;
    /// assert_eq!([-2.0, 0.0, 2.0].map(wall), [0.0, 0.0, 16.0]);
    /// ```
    #[inline(always)]
    pub fn select(self, at_least_zero: impl Into<Self>, below: impl Into<Self>) -> Self {
        Num(S::select(self.0, at_least_zero.into().0, below.into().0))
    }

    /// xⁿ for an integer n.
    #[inline(always)]
    pub fn powi(self, n: i32) -> Self {
        Num(S::powi(self.0, n))
    }

    /// xᶜ for a constant exponent: `r.powf(-1.5)`, `r.powf(ratio(1, 3))`. Half-integers up to 15/2 cost one
    /// square root.
    #[inline(always)]
    pub fn powf(self, c: impl Into<Constant>) -> Self {
        Num(S::powf(self.0, c.into()))
    }

    /// xʸ for a variable exponent.
    #[inline(always)]
    pub fn pow(self, y: Self) -> Self {
        Num(S::pow(self.0, y.0))
    }

    /// Angle of the point (x, `self`).
    #[inline(always)]
    pub fn atan2(self, x: Self) -> Self {
        Num(S::atan2(self.0, x.0))
    }

    /// √(x² + y²).
    #[inline(always)]
    pub fn hypot(self, y: Self) -> Self {
        Num(S::hypot(self.0, y.0))
    }

    /// The smaller of two.
    #[inline(always)]
    pub fn min(self, other: impl Into<Self>) -> Self {
        Num(S::min(self.0, other.into().0))
    }

    /// The larger of two.
    #[inline(always)]
    pub fn max(self, other: impl Into<Self>) -> Self {
        Num(S::max(self.0, other.into().0))
    }

    /// (sin x, cos x).
    #[inline(always)]
    pub fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }
}

impl<S: Scalar> From<Constant> for Num<S> {
    #[inline(always)]
    fn from(c: Constant) -> Self {
        Num(S::constant(c))
    }
}

macro_rules! from_constant_kind {
    ($($kind:ty),*) => {$(
        impl<S: Scalar> From<$kind> for Num<S> {
            #[inline(always)]
            fn from(x: $kind) -> Self {
                Num(S::constant(Constant::from(x)))
            }
        }
    )*};
}
from_constant_kind!(f64, i32, DoubleDouble);

impl<S: Scalar> Neg for Num<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Num(-self.0)
    }
}

impl<S: Scalar> Neg for &Num<S> {
    type Output = Num<S>;
    #[inline(always)]
    fn neg(self) -> Num<S> {
        -*self
    }
}

/// One operator between numbers, references to them, and constants on either side.
macro_rules! operator {
    ($op:ident, $f:ident, $op_assign:ident, $f_assign:ident; $($kind:ty),*) => {
        impl<S: Scalar> $op for Num<S> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, other: Self) -> Self {
                Num(self.0.$f(other.0))
            }
        }
        impl<S: Scalar> $op<&Num<S>> for Num<S> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, other: &Self) -> Self {
                self.$f(*other)
            }
        }
        impl<S: Scalar, R> $op<R> for &Num<S>
        where
            Num<S>: $op<R, Output = Num<S>>,
        {
            type Output = Num<S>;
            #[inline(always)]
            fn $f(self, other: R) -> Num<S> {
                (*self).$f(other)
            }
        }
        impl<S: Scalar, R> $op_assign<R> for Num<S>
        where
            Num<S>: $op<R, Output = Num<S>>,
        {
            #[inline(always)]
            fn $f_assign(&mut self, other: R) {
                *self = (*self).$f(other);
            }
        }
        $(
            impl<S: Scalar> $op<$kind> for Num<S> {
                type Output = Self;
                #[inline(always)]
                fn $f(self, other: $kind) -> Self {
                    self.$f(Num::from(other))
                }
            }
            impl<S: Scalar> $op<Num<S>> for $kind {
                type Output = Num<S>;
                #[inline(always)]
                fn $f(self, other: Num<S>) -> Num<S> {
                    Num::from(self).$f(other)
                }
            }
            impl<S: Scalar> $op<&Num<S>> for $kind {
                type Output = Num<S>;
                #[inline(always)]
                fn $f(self, other: &Num<S>) -> Num<S> {
                    Num::from(self).$f(*other)
                }
            }
        )*
    };
}
operator!(Add, add, AddAssign, add_assign; f64, i32, Constant, DoubleDouble);
operator!(Sub, sub, SubAssign, sub_assign; f64, i32, Constant, DoubleDouble);
operator!(Mul, mul, MulAssign, mul_assign; f64, i32, Constant, DoubleDouble);
operator!(Div, div, DivAssign, div_assign; f64, i32, Constant, DoubleDouble);

impl<S: Scalar> Sum for Num<S> {
    #[inline(always)]
    fn sum<I: Iterator<Item = Self>>(mut terms: I) -> Self {
        let first = terms.next().unwrap_or_else(|| Num::from(0.0));
        terms.fold(first, |sum, term| sum + term)
    }
}

impl<S: Scalar> Product for Num<S> {
    #[inline(always)]
    fn product<I: Iterator<Item = Self>>(mut factors: I) -> Self {
        let first = factors.next().unwrap_or_else(|| Num::from(1.0));
        factors.fold(first, |product, factor| product * factor)
    }
}
