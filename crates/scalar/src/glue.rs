//! One glue between our float types and num-traits, num-dual, approx and nalgebra.
//!
//! `float_glue!(T)` writes every impl these crates ask for by forwarding to inherent functions of `T` that
//! are named as those of `f64`. A new float type brings:
//!
//! - `Copy`, `Debug`, `Display`, `PartialEq`, `PartialOrd`, `FromStr<Err = ParseFloatError>`, `From<f64>`,
//!   `+ − × ÷ %` and negation by value, and our [`Float`](crate::Float);
//! - the elementary functions of `f64` by the same names and signatures;
//! - `from_i64`, `from_u64`, `from_i128`, `from_u128`, `to_i128`, `to_u128`, `hi` (the nearest double);
//! - `small` (a `const fn` from `f64`) and the constants `ZERO`, `ONE`, `THIRD`, `MIN`, `NEG_INFINITY` and
//!   those of `std::f64::consts`.

#[macro_use]
mod num_dual;
#[macro_use]
mod num_traits;
#[macro_use]
mod simba;
#[cfg(feature = "serde")]
mod serialised;

/// What num-dual asks of the float below its dual numbers.
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

/// Functions without arguments that return a constant.
macro_rules! constants {
    ($t:ty; $($f:ident = $c:ident),* $(,)?) => {$(
        #[inline(always)]
        fn $f() -> Self {
            <$t>::$c
        }
    )*};
}

/// An operator between references, its assigning form, and both with references.
macro_rules! operator_glue {
    ($t:ty; $($op:ident $f:ident $assign:ident $f_assign:ident),*) => {$(
        impl std::ops::$op<&$t> for $t {
            type Output = $t;
            #[inline(always)]
            fn $f(self, other: &$t) -> $t {
                std::ops::$op::$f(self, *other)
            }
        }
        impl std::ops::$op<$t> for &$t {
            type Output = $t;
            #[inline(always)]
            fn $f(self, other: $t) -> $t {
                std::ops::$op::$f(*self, other)
            }
        }
        impl std::ops::$op<&$t> for &$t {
            type Output = $t;
            #[inline(always)]
            fn $f(self, other: &$t) -> $t {
                std::ops::$op::$f(*self, *other)
            }
        }
        impl std::ops::$assign for $t {
            #[inline(always)]
            fn $f_assign(&mut self, other: $t) {
                *self = std::ops::$op::$f(*self, other);
            }
        }
        impl std::ops::$assign<&$t> for $t {
            #[inline(always)]
            fn $f_assign(&mut self, other: &$t) {
                *self = std::ops::$op::$f(*self, *other);
            }
        }
    )*};
}

/// All foreign traits of a float type. See the head of this file for what the type brings.
macro_rules! float_glue {
    ($t:ty) => {
        const _: () = {
            operator_glue!($t; Add add AddAssign add_assign, Sub sub SubAssign sub_assign,
                Mul mul MulAssign mul_assign, Div div DivAssign div_assign, Rem rem RemAssign rem_assign);
            std_glue!($t);
            num_traits_glue!($t);
            num_dual_glue!($t);
            approx_glue!($t);
            simba_glue!($t);
        };
    };
}

macro_rules! std_glue {
    ($t:ty) => {
        impl std::ops::Neg for &$t {
            type Output = $t;
            #[inline(always)]
            fn neg(self) -> $t {
                -*self
            }
        }
        impl std::iter::Sum for $t {
            fn sum<I: Iterator<Item = $t>>(terms: I) -> $t {
                terms.fold(<$t>::ZERO, |sum, term| sum + term)
            }
        }
        impl<'a> std::iter::Sum<&'a $t> for $t {
            fn sum<I: Iterator<Item = &'a $t>>(terms: I) -> $t {
                terms.fold(<$t>::ZERO, |sum, term| sum + *term)
            }
        }
        impl std::iter::Product for $t {
            fn product<I: Iterator<Item = $t>>(factors: I) -> $t {
                factors.fold(<$t>::ONE, |product, factor| product * factor)
            }
        }
        impl<'a> std::iter::Product<&'a $t> for $t {
            fn product<I: Iterator<Item = &'a $t>>(factors: I) -> $t {
                factors.fold(<$t>::ONE, |product, factor| product * *factor)
            }
        }
    };
}

macro_rules! approx_glue {
    ($t:ty) => {
        impl ::approx::AbsDiffEq for $t {
            type Epsilon = $t;
            #[inline(always)]
            fn default_epsilon() -> $t {
                <$t>::EPSILON
            }
            fn abs_diff_eq(&self, other: &$t, epsilon: $t) -> bool {
                *self == *other || <$t>::abs(*self - *other) <= epsilon
            }
        }
        impl ::approx::RelativeEq for $t {
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
        impl ::approx::UlpsEq for $t {
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
