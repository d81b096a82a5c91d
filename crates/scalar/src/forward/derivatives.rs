//! What dual numbers are asked for: their derivatives, and the selections of piecewise functions.

use super::{Chain, Forward, Forward2};
use crate::constant::Constant;
use crate::glue::DualFloat;
use crate::traits::{FirstOrder, Float, Piecewise, Scalar, SecondOrder};
use num_dual::{Derivative, Dual2SVec, DualSVec};

impl<T: DualFloat + Float, const N: usize> FirstOrder<T, N> for Forward<T, N> {
    #[inline(always)]
    fn with_gradient(x: T, gradient: [T; N]) -> Self {
        Forward(DualSVec::new(x, Derivative::some(gradient.into())))
    }
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
    fn with_gradient(x: T, gradient: [T; N]) -> Self {
        let gradient = Derivative::some(nalgebra::RowSVector::from_fn(|_, i| gradient[i]));
        Forward2(Dual2SVec::new(x, gradient, Derivative::none()))
    }
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

macro_rules! piecewise {
    ($name:ident, $inner:ident) => {
        /// Selections by the value; their derivatives are zero.
        impl<T: DualFloat + Float, const N: usize> Piecewise for $name<T, N> {
            #[inline(always)]
            fn sign(x: Self) -> Self {
                $name($inner::from_re(Piecewise::sign(x.0.re)))
            }
            #[inline(always)]
            fn at_most(x: Self, y: Self) -> Self {
                $name($inner::from_re(Piecewise::at_most(x.0.re, y.0.re)))
            }
            #[inline(always)]
            fn where_nonzero(x: Self, test: Self) -> Self {
                if test.0.re == T::int(0) {
                    $name($inner::from_re(T::int(0)))
                } else {
                    x
                }
            }
            #[inline(always)]
            fn times_derivative(rate: Self, derivative: Self) -> Self {
                let mut product = rate.0 * derivative.0;
                product.re = Piecewise::times_derivative(rate.0.re, derivative.0.re);
                $name(product)
            }
            /// The derivative of c·xᶜ⁻¹ is (c − 1) times it over x, or from the next power where that says
            /// nothing.
            #[inline(always)]
            fn powf_derivative(x: Self, power: Self, c: Constant) -> Self {
                let f = Piecewise::powf_derivative(x.0.re, power.0.re, c);
                let factor: T = c.to();
                let [less, two_less] = [1, 2].map(|k| factor - T::int(k));
                let derivative = if f != T::int(0) && Piecewise::is_regular(f) {
                    Piecewise::where_nonzero(less * f / x.0.re, less)
                } else {
                    let next = <T as Scalar>::pow(x.0.re, two_less);
                    Piecewise::where_nonzero(factor * less * next, factor * less)
                };
                $name(x.0.chain_any(
                    f,
                    derivative,
                    Piecewise::where_nonzero(two_less * derivative / x.0.re, derivative),
                ))
            }
            #[inline(always)]
            fn is_regular(x: Self) -> bool {
                Piecewise::is_regular(x.0.re)
            }
        }
    };
}
piecewise!(Forward, DualSVec);
piecewise!(Forward2, Dual2SVec);
