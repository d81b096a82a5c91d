//! Forward dual numbers over any [`Float`], through num-dual, which stays a private field.

use crate::glue::DualFloat;
use crate::{Constant, Float, Scalar};
use num_dual::{Derivative, Dual2SVec, DualNum, DualSVec};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number that carries N first derivatives.
pub trait FirstOrder<T, const N: usize>: Scalar {
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

/// Dual number with N first derivatives.
#[derive(Debug, Clone, Copy)]
pub struct Forward<T: DualFloat, const N: usize>(DualSVec<T, N>);

/// Dual number with N first and N×N second derivatives.
#[derive(Debug, Clone, Copy)]
pub struct Forward2<T: DualFloat, const N: usize>(Dual2SVec<T, N>);

impl<T: DualFloat + Float, const N: usize> FirstOrder<T, N> for Forward<T, N> {
    #[inline(always)]
    fn variable(x: T, index: usize) -> Self {
        Forward(DualSVec::from_re(x).derivative(index))
    }
    #[inline(always)]
    fn value(&self) -> T {
        self.0.re
    }
    #[inline(always)]
    fn gradient(&self) -> [T; N] {
        match &self.0.eps {
            Derivative(Some(d)) => std::array::from_fn(|i| d[i]),
            Derivative(None) => [T::int(0); N],
        }
    }
}

impl<T: DualFloat + Float, const N: usize> FirstOrder<T, N> for Forward2<T, N> {
    #[inline(always)]
    fn variable(x: T, index: usize) -> Self {
        Forward2(Dual2SVec::from_re(x).derivative(index))
    }
    #[inline(always)]
    fn value(&self) -> T {
        self.0.re
    }
    #[inline(always)]
    fn gradient(&self) -> [T; N] {
        match &self.0.v1 {
            Derivative(Some(d)) => std::array::from_fn(|i| d[i]),
            Derivative(None) => [T::int(0); N],
        }
    }
}

impl<T: DualFloat + Float, const N: usize> SecondOrder<T, N> for Forward2<T, N> {
    #[inline(always)]
    fn hessian(&self) -> [[T; N]; N] {
        match &self.0.v2 {
            Derivative(Some(d)) => std::array::from_fn(|i| std::array::from_fn(|j| d[(i, j)])),
            Derivative(None) => [[T::int(0); N]; N],
        }
    }
}

macro_rules! scalar_by_num_dual {
    ($name:ident, $inner:ident) => {
        scalar_by_num_dual!(@op $name, Add, add);
        // num-dual's difference is a call the compiler does not inline; the sum with the negative has the
        // same bits. Measured on the gradient of Kepler: 5.3 ns against 12 ns.
        impl<T: DualFloat, const N: usize> Sub for $name<T, N> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                $name(self.0 + -other.0)
            }
        }
        scalar_by_num_dual!(@op $name, Mul, mul);

        impl<T: DualFloat, const N: usize> Div for $name<T, N> {
            type Output = Self;
            #[inline(always)]
            fn div(self, other: Self) -> Self {
                $name(self.0 / other.0)
            }
        }

        impl<T: DualFloat, const N: usize> Neg for $name<T, N> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                $name(-self.0)
            }
        }

        impl<T: DualFloat + Float, const N: usize> Scalar for $name<T, N> {
            #[inline(always)]
            fn constant(c: Constant) -> Self {
                $name($inner::from_re(c.to::<T>()))
            }
            #[inline(always)]
            fn recip(x: Self) -> Self {
                $name(x.0.recip())
            }
            #[inline(always)]
            fn powi(x: Self, n: i32) -> Self {
                $name(x.0.powi(n))
            }
            #[inline(always)]
            fn powf(x: Self, c: Constant) -> Self {
                $name(x.0.powf(c.to::<T>()))
            }
            #[inline(always)]
            fn pow(x: Self, y: Self) -> Self {
                $name(x.0.powd(y.0))
            }
            #[inline(always)]
            fn atan2(y: Self, x: Self) -> Self {
                $name(y.0.atan2(x.0))
            }
            #[inline(always)]
            fn hypot(x: Self, y: Self) -> Self {
                $name((x.0 * x.0 + y.0 * y.0).sqrt())
            }
            #[inline(always)]
            fn abs(x: Self) -> Self {
                if x.0.re < T::int(0) { -x } else { x }
            }
            #[inline(always)]
            fn min(x: Self, y: Self) -> Self {
                if x.0.re <= y.0.re { x } else { y }
            }
            #[inline(always)]
            fn max(x: Self, y: Self) -> Self {
                if x.0.re >= y.0.re { x } else { y }
            }
            scalar_by_num_dual!(@functions $name, sqrt, exp, ln, exp_m1, ln_1p, sin, cos, tan, asin,
                acos, atan, sinh, cosh, tanh);
        }
    };
    (@op $name:ident, $op:ident, $f:ident) => {
        impl<T: DualFloat, const N: usize> $op for $name<T, N> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, other: Self) -> Self {
                $name(self.0.$f(other.0))
            }
        }
    };
    (@functions $name:ident, $($f:ident),*) => {$(
        #[inline(always)]
        fn $f(x: Self) -> Self {
            $name(x.0.$f())
        }
    )*};
}
scalar_by_num_dual!(Forward, DualSVec);
scalar_by_num_dual!(Forward2, Dual2SVec);
