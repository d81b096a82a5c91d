//! The trait implementations for our float types that num-traits, num-dual, approx and nalgebra require.
//!
//! `float_glue!([] T)` generates these implementations. They forward to inherent functions of `T` with the
//! names of those of `f64`. The macro also writes the functions that all floats share (`inherent`), and
//! decimal text. A generic type has its parameters in the brackets. A new float type provides:
//!
//! - `Copy`, `Debug`, `PartialEq`, `PartialOrd`, `From<f64>`, `+ − × ÷ %` and negation by value, and our
//!   [`Float`](crate::Float);
//! - the elementary functions of `f64` by the same names and signatures, and what `inherent` requires;
//! - `from_i64`, `from_u64`, `from_i128`, `from_u128`, `to_i128`, `to_u128`, `hi` (the nearest double),
//!   `nearest` (to a decimal), `digits`;
//! - the limits of [`Float`](crate::Float) as constants, and `small` (a double, exactly);
//! - num-traits' `FloatConst` and num-dual's `DualNumFloat`.
//!
//! [`Own`](crate::Own) provides them for every type that has arithmetic.

#[macro_use]
mod inherent;
#[macro_use]
mod num_dual;
#[macro_use]
mod num_traits;
#[macro_use]
mod simba;
#[macro_use]
mod text;
#[cfg(feature = "serde")]
mod serialised;

/// The requirements of num-dual on the float type of its dual numbers.
pub trait DualFloat: ::num_dual::DualNum<Primitive = Self> + ::num_dual::DualNumFloat {}

impl<T: ::num_dual::DualNum<Primitive = T> + ::num_dual::DualNumFloat> DualFloat for T {}

/// Forwards functions of one receiver (by value or by reference) and further arguments to inherent ones.
macro_rules! forward {
    ($t:ty, value; $($f:ident($($arg:ident: $type:ty),*) -> $out:ty;)*) => {$(
        #[inline(always)]
        fn $f(self $(, $arg: $type)*) -> $out {
            <$t>::$f(self $(, $arg)*)
        }
    )*};
    ($t:ty, reference; $($f:ident($($arg:ident: $type:ty),*) -> $out:ty;)*) => {$(
        #[inline(always)]
        fn $f(&self $(, $arg: $type)*) -> $out {
            <$t>::$f(*self $(, $arg)*)
        }
    )*};
    ($t:ty, $receiver:ident: $($f:ident),*) => {
        forward!($t, $receiver; $($f() -> Self;)*);
    };
}

/// Functions without arguments that return a limit of the type, or a constant of num-traits.
macro_rules! constants {
    ($t:ty; $($f:ident = $c:ident),* $(,)?) => {$(
        #[inline(always)]
        fn $f() -> Self {
            <$t>::$c
        }
    )*};
    ($t:ty, named; $($f:ident = $c:ident),* $(,)?) => {$(
        #[inline(always)]
        fn $f() -> Self {
            <$t as ::num_traits::FloatConst>::$c()
        }
    )*};
}

/// An operator between references, its assigning form, and both with references.
macro_rules! operator_glue {
    ($g:tt $t:ty; $($op:ident $f:ident $assign:ident $f_assign:ident),*) => {$(
        operator_glue!(@one $g $t; $op $f $assign $f_assign);
    )*};
    (@one [$($g:tt)*] $t:ty; $op:ident $f:ident $assign:ident $f_assign:ident) => {
        impl<$($g)*> std::ops::$op<&$t> for $t {
            type Output = $t;
            #[inline(always)]
            fn $f(self, other: &$t) -> $t {
                std::ops::$op::$f(self, *other)
            }
        }
        impl<$($g)*> std::ops::$op<$t> for &$t {
            type Output = $t;
            #[inline(always)]
            fn $f(self, other: $t) -> $t {
                std::ops::$op::$f(*self, other)
            }
        }
        impl<$($g)*> std::ops::$op<&$t> for &$t {
            type Output = $t;
            #[inline(always)]
            fn $f(self, other: &$t) -> $t {
                std::ops::$op::$f(*self, *other)
            }
        }
        impl<$($g)*> std::ops::$assign for $t {
            #[inline(always)]
            fn $f_assign(&mut self, other: $t) {
                *self = std::ops::$op::$f(*self, other);
            }
        }
        impl<$($g)*> std::ops::$assign<&$t> for $t {
            #[inline(always)]
            fn $f_assign(&mut self, other: &$t) {
                *self = std::ops::$op::$f(*self, *other);
            }
        }
    };
}

/// All foreign traits of a float type. See the head of this file for what the type brings.
macro_rules! float_glue {
    ($g:tt $t:ty) => {
        const _: () = {
            inherent_glue!($g $t);
            text_glue!($g $t);
            operator_glue!($g $t; Add add AddAssign add_assign, Sub sub SubAssign sub_assign,
                Mul mul MulAssign mul_assign, Div div DivAssign div_assign, Rem rem RemAssign rem_assign);
            std_glue!($g $t);
            num_traits_glue!($g $t);
            num_dual_glue!($g $t);
            approx_glue!($g $t);
            simba_glue!($g $t);
        };
    };
}

macro_rules! std_glue {
    ([$($g:tt)*] $t:ty) => {
        impl<$($g)*> std::ops::Neg for &$t {
            type Output = $t;
            #[inline(always)]
            fn neg(self) -> $t {
                -*self
            }
        }
        impl<$($g)*> std::iter::Sum for $t {
            fn sum<I: Iterator<Item = $t>>(terms: I) -> $t {
                terms.fold(<$t>::small(0.0), |sum, term| sum + term)
            }
        }
        impl<'a, $($g)*> std::iter::Sum<&'a $t> for $t {
            fn sum<I: Iterator<Item = &'a $t>>(terms: I) -> $t {
                terms.fold(<$t>::small(0.0), |sum, term| sum + *term)
            }
        }
        impl<$($g)*> std::iter::Product for $t {
            fn product<I: Iterator<Item = $t>>(factors: I) -> $t {
                factors.fold(<$t>::small(1.0), |product, factor| product * factor)
            }
        }
        impl<'a, $($g)*> std::iter::Product<&'a $t> for $t {
            fn product<I: Iterator<Item = &'a $t>>(factors: I) -> $t {
                factors.fold(<$t>::small(1.0), |product, factor| product * *factor)
            }
        }
    };
}

macro_rules! approx_glue {
    ([$($g:tt)*] $t:ty) => {
        impl<$($g)*> ::approx::AbsDiffEq for $t {
            type Epsilon = $t;
            #[inline(always)]
            fn default_epsilon() -> $t {
                <$t>::EPSILON
            }
            fn abs_diff_eq(&self, other: &$t, epsilon: $t) -> bool {
                *self == *other || <$t>::abs(*self - *other) <= epsilon
            }
        }
        impl<$($g)*> ::approx::RelativeEq for $t {
            #[inline(always)]
            fn default_max_relative() -> $t {
                <$t>::EPSILON
            }
            fn relative_eq(&self, other: &$t, epsilon: $t, max_relative: $t) -> bool {
                if *self == *other {
                    return true;
                }
                if !<$t>::is_finite(*self) || !<$t>::is_finite(*other) {
                    return false;
                }
                let distance = <$t>::abs(*self - *other);
                let largest = <$t>::max(<$t>::abs(*self), <$t>::abs(*other));
                distance <= epsilon || distance <= largest * max_relative
            }
        }
        impl<$($g)*> ::approx::UlpsEq for $t {
            fn default_max_ulps() -> u32 {
                4
            }
            /// One unit in the last place being ε times the larger of the two.
            fn ulps_eq(&self, other: &$t, epsilon: $t, max_ulps: u32) -> bool {
                let relative = <$t>::EPSILON * <$t>::from(f64::from(max_ulps));
                ::approx::RelativeEq::relative_eq(self, other, epsilon, relative)
            }
        }
    };
}
