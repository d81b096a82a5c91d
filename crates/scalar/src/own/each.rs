//! [`Each`]: N numbers of a float type without vectors, one by one.

use crate::constant::Constant;
use crate::traits::{Float, Outside, Pack, Scalar};
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// N numbers that are processed one by one.
#[derive(Debug, Clone, Copy)]
pub struct Each<T, const N: usize>([T; N]);

macro_rules! each {
    ($of:ident: $($f:ident($($x:ident),*)),*) => {$(
        #[inline(always)]
        fn $f($($x: Self),*) -> Self {
            Each(from_fn(|k| <T as $of>::$f($($x.0[k]),*)))
        }
    )*};
}

macro_rules! operators {
    ($($op:ident $f:ident),*) => {$(
        impl<T: Float, const N: usize> $op for Each<T, N> {
            type Output = Self;
            each!($op: $f(self, other));
        }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl<T: Float, const N: usize> Neg for Each<T, N> {
    type Output = Self;
    each!(Neg: neg(self));
}

impl<T: Float, const N: usize> Scalar for Each<T, N> {
    #[inline(always)]
    fn constant(c: Constant) -> Self {
        Each([c.to(); N])
    }
    #[inline(always)]
    fn powi(x: Self, n: i32) -> Self {
        Each(x.0.map(|x| <T as Scalar>::powi(x, n)))
    }
    #[inline(always)]
    fn powf(x: Self, c: Constant) -> Self {
        Each(x.0.map(|x| <T as Scalar>::powf(x, c)))
    }
    #[inline(always)]
    fn powf_derivative(x: Self, power: Self, c: Constant) -> Self {
        Each(from_fn(|k| T::powf_derivative(x.0[k], power.0[k], c)))
    }
    #[inline(always)]
    fn outside(f: &Arc<dyn Outside>, orders: [u8; 2], [x, y]: [Self; 2]) -> Self {
        Each(from_fn(|k| T::outside(f, orders, [x.0[k], y.0[k]])))
    }
    each!(Scalar: recip(x), sqrt(x), cbrt(x), exp(x), exp2(x), ln(x), exp_m1(x), ln_1p(x), sin(x), cos(x), tan(x),
        asin(x), acos(x), atan(x), sinh(x), cosh(x), tanh(x), asinh(x), acosh(x), atanh(x), erf(x), erfc(x), abs(x),
        signum(x), pow(x, y), atan2(x, y), hypot(x, y), min(x, y), max(x, y), at_most(x, y), where_nonzero(x, y));
}

impl<T: Float, const N: usize> Pack<T, N> for Each<T, N> {
    #[inline(always)]
    fn splat(x: T) -> Self {
        Each([x; N])
    }
    #[inline(always)]
    fn of(from: &[T; N]) -> Self {
        Each(*from)
    }
    #[inline(always)]
    fn numbers(self) -> [T; N] {
        self.0
    }
    #[inline(always)]
    fn heads(self) -> [f64; N] {
        self.0.map(T::to_f64)
    }
    fn total(packs: &[[T; N]]) -> (T, T) {
        let zero = T::int(0);
        packs
            .as_flattened()
            .iter()
            .fold((zero, zero), |(sum, lost), &x| {
                let (sum, rest) = T::two_sum(sum, x);
                (sum, lost + rest)
            })
    }
}
