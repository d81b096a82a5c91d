//! One glue between our float types and num-traits, num-dual, approx and nalgebra.
//!
//! `float_glue!(T)` writes every impl these crates ask for by forwarding to inherent functions of `T` that are named
//! as those of `f64`. A new float type brings:
//!
//! - `Copy`, `Debug`, `Display`, `PartialEq`, `PartialOrd`, `FromStr<Err = ParseFloatError>`, `From<f64>`,
//!   `+ − × ÷ %` and negation by value, and our [`Float`](crate::Float);
//! - the elementary functions of `f64` by the same names and signatures;
//! - `from_i64`, `from_u64`, `from_i128`, `from_u128`, `to_i128`, `to_u128`, `hi` (the nearest double);
//! - `small` (a `const fn` from `f64`) and the constants `ZERO`, `ONE`, `THIRD`, `MIN`, `NEG_INFINITY` and those of `std::f64::consts`.

/// What num-dual asks of the float below its dual numbers.
pub trait DualFloat: num_dual::DualNum<Primitive = Self> + num_dual::DualNumFloat {}

impl<T: num_dual::DualNum<Primitive = T> + num_dual::DualNumFloat> DualFloat for T {}

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

macro_rules! num_traits_glue {
    ($t:ty) => {
        impl num_traits::Zero for $t {
            #[inline(always)]
            fn zero() -> $t {
                <$t>::ZERO
            }
            #[inline(always)]
            fn is_zero(&self) -> bool {
                *self == <$t>::ZERO
            }
        }
        impl num_traits::One for $t {
            #[inline(always)]
            fn one() -> $t {
                <$t>::ONE
            }
        }
        impl num_traits::Num for $t {
            type FromStrRadixErr = $crate::ParseFloatError;
            /// Decimals only.
            fn from_str_radix(text: &str, radix: u32) -> Result<$t, $crate::ParseFloatError> {
                if radix == 10 { text.parse() } else { Err($crate::ParseFloatError { text: text.into() }) }
            }
        }
        impl num_traits::Inv for $t {
            type Output = $t;
            #[inline(always)]
            fn inv(self) -> $t {
                <$t>::recip(self)
            }
        }
        impl num_traits::Bounded for $t {
            constants!($t; min_value = MIN, max_value = MAX);
        }
        impl num_traits::FromPrimitive for $t {
            fn from_i64(n: i64) -> Option<$t> {
                Some(<$t>::from_i64(n))
            }
            fn from_u64(n: u64) -> Option<$t> {
                Some(<$t>::from_u64(n))
            }
            fn from_i128(n: i128) -> Option<$t> {
                Some(<$t>::from_i128(n))
            }
            fn from_u128(n: u128) -> Option<$t> {
                Some(<$t>::from_u128(n))
            }
            #[inline(always)]
            fn from_f64(x: f64) -> Option<$t> {
                Some(<$t>::from(x))
            }
        }
        impl num_traits::ToPrimitive for $t {
            fn to_i64(&self) -> Option<i64> {
                <$t>::to_i128(*self)?.try_into().ok()
            }
            fn to_u64(&self) -> Option<u64> {
                <$t>::to_u128(*self)?.try_into().ok()
            }
            fn to_i128(&self) -> Option<i128> {
                <$t>::to_i128(*self)
            }
            fn to_u128(&self) -> Option<u128> {
                <$t>::to_u128(*self)
            }
            #[inline(always)]
            fn to_f64(&self) -> Option<f64> {
                Some(<$t>::hi(*self))
            }
        }
        impl num_traits::NumCast for $t {
            /// Floats through `f64`; integers beyond 2⁵³ whole.
            fn from<N: num_traits::ToPrimitive>(n: N) -> Option<$t> {
                let double = n.to_f64()?;
                let integer = if double.abs() < 9e15 { None } else { n.to_i128() };
                Some(integer.map_or(<$t as From<f64>>::from(double), <$t>::from_i128))
            }
        }
        impl num_traits::Signed for $t {
            forward!($t, reference: abs, signum);
            fn abs_sub(&self, other: &$t) -> $t {
                <$t>::max(*self - *other, <$t>::ZERO)
            }
            #[inline(always)]
            fn is_positive(&self) -> bool {
                <$t>::is_sign_positive(*self)
            }
            #[inline(always)]
            fn is_negative(&self) -> bool {
                <$t>::is_sign_negative(*self)
            }
        }
        impl num_traits::Float for $t {
            constants!($t; nan = NAN, infinity = INFINITY, neg_infinity = NEG_INFINITY, min_value = MIN,
                max_value = MAX, min_positive_value = MIN_POSITIVE, epsilon = EPSILON);
            fn neg_zero() -> $t {
                -<$t>::ZERO
            }
            forward!($t, value: floor, ceil, round, trunc, fract, abs, signum, recip, sqrt, cbrt, exp, exp2, exp_m1,
                ln, ln_1p, log2, log10, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, asinh, acosh, atanh,
                to_degrees, to_radians);
            forward!($t, value;
                is_nan() -> bool;
                is_infinite() -> bool;
                is_finite() -> bool;
                classify() -> std::num::FpCategory;
                is_sign_positive() -> bool;
                is_sign_negative() -> bool;
                powi(n: i32) -> $t;
                powf(y: $t) -> $t;
                log(base: $t) -> $t;
                min(other: $t) -> $t;
                max(other: $t) -> $t;
                hypot(other: $t) -> $t;
                atan2(x: $t) -> $t;
                copysign(sign: $t) -> $t;
                sin_cos() -> ($t, $t);
            );
            fn is_normal(self) -> bool {
                <$t>::classify(self) == std::num::FpCategory::Normal
            }
            #[inline(always)]
            fn mul_add(self, a: $t, b: $t) -> $t {
                self * a + b
            }
            fn abs_sub(self, other: $t) -> $t {
                <$t>::max(self - other, <$t>::ZERO)
            }
            /// Of the nearest double.
            fn integer_decode(self) -> (u64, i16, i8) {
                num_traits::Float::integer_decode(<$t>::hi(self))
            }
        }
        impl num_traits::FloatConst for $t {
            constants!($t; E = E, FRAC_1_PI = FRAC_1_PI, FRAC_1_SQRT_2 = FRAC_1_SQRT_2, FRAC_2_PI = FRAC_2_PI,
                FRAC_2_SQRT_PI = FRAC_2_SQRT_PI, FRAC_PI_2 = FRAC_PI_2, FRAC_PI_3 = FRAC_PI_3,
                FRAC_PI_4 = FRAC_PI_4, FRAC_PI_6 = FRAC_PI_6, FRAC_PI_8 = FRAC_PI_8, LN_10 = LN_10, LN_2 = LN_2,
                LOG10_E = LOG10_E, LOG2_E = LOG2_E, PI = PI, SQRT_2 = SQRT_2, TAU = TAU, LOG10_2 = LOG10_2,
                LOG2_10 = LOG2_10);
        }
    };
}

macro_rules! num_dual_glue {
    ($t:ty) => {
        impl num_dual::DualStruct for $t {
            type Real = $t;
            type Inner = $t;
            #[inline(always)]
            fn re(&self) -> $t {
                *self
            }
            #[inline(always)]
            fn from_inner(inner: &$t) -> $t {
                *inner
            }
        }
        impl num_dual::Mappable<$t> for $t {
            type Output<O> = O;
            #[inline(always)]
            fn map_dual<M: Fn($t) -> O, O>(self, f: M) -> O {
                f(self)
            }
        }
        impl num_dual::DualNum for $t {
            type Primitive = $t;
            const NDERIV: usize = 0;
            type InnerDual = $t;
            #[inline(always)]
            fn from_re(re: $t) -> $t {
                re
            }
            #[inline(always)]
            fn scale(self, factor: &$t) -> $t {
                self * *factor
            }
            forward!($t, reference: recip, sqrt, cbrt, exp, exp2, exp_m1, ln, log2, log10, ln_1p, sin, cos, tan,
                asin, acos, atan, sinh, cosh, tanh, asinh, acosh, atanh);
            forward!($t, reference;
                powi(n: i32) -> $t;
                powf(n: $t) -> $t;
                log(base: $t) -> $t;
                atan2(x: $t) -> $t;
                sin_cos() -> ($t, $t);
            );
            #[inline(always)]
            fn powd(&self, n: $t) -> $t {
                <$t>::powf(*self, n)
            }
            fn sph_j0(&self) -> $t {
                if *self == <$t>::ZERO { <$t>::ONE } else { <$t>::sin(*self) / *self }
            }
            /// Cancels like ε/x² for small x.
            fn sph_j1(&self) -> $t {
                let x = *self;
                if <$t>::abs(x) < <$t>::sqrt(<$t>::EPSILON) {
                    return x / <$t>::from(3.0);
                }
                let (s, c) = <$t>::sin_cos(x);
                (s / x - c) / x
            }
            /// Cancels like ε/x⁴ for small x.
            fn sph_j2(&self) -> $t {
                let x = *self;
                if <$t>::abs(x) < <$t>::sqrt(<$t>::EPSILON) {
                    return x * x / <$t>::from(15.0);
                }
                let (s, c) = <$t>::sin_cos(x);
                let three = <$t>::from(3.0);
                ((three / (x * x) - <$t>::ONE) * s - three * c / x) / x
            }
        }
        impl num_dual::DualNumFloat for $t {
            const THIRD: $t = <$t>::THIRD;
            const HALF: $t = <$t>::small(0.5);
            const TWO: $t = <$t>::small(2.0);
            const THREE: $t = <$t>::small(3.0);
            const FOUR: $t = <$t>::small(4.0);
            const SIX: $t = <$t>::small(6.0);
            const TEN: $t = <$t>::small(10.0);
            const FIFTEEN: $t = <$t>::small(15.0);
        }
    };
}

macro_rules! approx_glue {
    ($t:ty) => {
        impl approx::AbsDiffEq for $t {
            type Epsilon = $t;
            #[inline(always)]
            fn default_epsilon() -> $t {
                <$t>::EPSILON
            }
            fn abs_diff_eq(&self, other: &$t, epsilon: $t) -> bool {
                *self == *other || <$t>::abs(*self - *other) <= epsilon
            }
        }
        impl approx::RelativeEq for $t {
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
        impl approx::UlpsEq for $t {
            fn default_max_ulps() -> u32 {
                4
            }
            /// One unit in the last place being ε times the larger of the two.
            fn ulps_eq(&self, other: &$t, epsilon: $t, max_ulps: u32) -> bool {
                let relative = <$t>::EPSILON * <$t>::from(f64::from(max_ulps));
                approx::RelativeEq::relative_eq(self, other, epsilon, relative)
            }
        }
    };
}

macro_rules! simba_glue {
    ($t:ty) => {
        impl simba::scalar::Field for $t {}
        impl simba::simd::PrimitiveSimdValue for $t {}
        impl simba::simd::SimdValue for $t {
            const LANES: usize = 1;
            type Element = $t;
            type SimdBool = bool;
            #[inline(always)]
            fn splat(value: $t) -> $t {
                value
            }
            #[inline(always)]
            fn extract(&self, _: usize) -> $t {
                *self
            }
            // simba declares these two `unsafe`; they do nothing that is.
            #[allow(unsafe_code)]
            #[inline(always)]
            unsafe fn extract_unchecked(&self, _: usize) -> $t {
                *self
            }
            #[inline(always)]
            fn replace(&mut self, _: usize, value: $t) {
                *self = value;
            }
            #[allow(unsafe_code)]
            #[inline(always)]
            unsafe fn replace_unchecked(&mut self, _: usize, value: $t) {
                *self = value;
            }
            #[inline(always)]
            fn select(self, condition: bool, other: $t) -> $t {
                if condition { self } else { other }
            }
        }
        subset_glue!($t; $t => |x: $t| x, |x: $t| x; f64 => |x: f64| <$t>::from(x), |x: $t| x.hi();
            f32 => |x: f32| <$t>::from(f64::from(x)), |x: $t| x.hi() as f32);
        impl simba::scalar::ComplexField for $t {
            type RealField = $t;
            forward!($t, value: floor, ceil, round, trunc, fract, abs, signum, recip, sqrt, cbrt, exp, exp2, exp_m1,
                ln, ln_1p, log2, log10, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, asinh, acosh, atanh);
            forward!($t, value;
                powi(n: i32) -> $t;
                powf(y: $t) -> $t;
                log(base: $t) -> $t;
                hypot(other: $t) -> $t;
                sin_cos() -> ($t, $t);
            );
            #[inline(always)]
            fn from_real(re: $t) -> $t {
                re
            }
            #[inline(always)]
            fn real(self) -> $t {
                self
            }
            #[inline(always)]
            fn imaginary(self) -> $t {
                <$t>::ZERO
            }
            #[inline(always)]
            fn modulus(self) -> $t {
                <$t>::abs(self)
            }
            #[inline(always)]
            fn modulus_squared(self) -> $t {
                self * self
            }
            fn argument(self) -> $t {
                if self >= <$t>::ZERO { <$t>::ZERO } else { <$t>::PI }
            }
            #[inline(always)]
            fn norm1(self) -> $t {
                <$t>::abs(self)
            }
            #[inline(always)]
            fn scale(self, factor: $t) -> $t {
                self * factor
            }
            #[inline(always)]
            fn unscale(self, factor: $t) -> $t {
                self / factor
            }
            fn to_exp(self) -> ($t, $t) {
                if self >= <$t>::ZERO { (self, <$t>::ONE) } else { (-self, -<$t>::ONE) }
            }
            #[inline(always)]
            fn mul_add(self, a: $t, b: $t) -> $t {
                self * a + b
            }
            #[inline(always)]
            fn conjugate(self) -> $t {
                self
            }
            #[inline(always)]
            fn powc(self, y: $t) -> $t {
                <$t>::powf(self, y)
            }
            #[inline(always)]
            fn is_finite(&self) -> bool {
                <$t>::is_finite(*self)
            }
            fn try_sqrt(self) -> Option<$t> {
                if self >= <$t>::ZERO { Some(<$t>::sqrt(self)) } else { None }
            }
        }
        impl simba::scalar::RealField for $t {
            #[inline(always)]
            fn is_sign_positive(&self) -> bool {
                <$t>::is_sign_positive(*self)
            }
            #[inline(always)]
            fn is_sign_negative(&self) -> bool {
                <$t>::is_sign_negative(*self)
            }
            forward!($t, value;
                copysign(sign: $t) -> $t;
                max(other: $t) -> $t;
                min(other: $t) -> $t;
                atan2(x: $t) -> $t;
            );
            fn clamp(self, min: $t, max: $t) -> $t {
                if self < min {
                    min
                } else if self > max {
                    max
                } else {
                    self
                }
            }
            fn min_value() -> Option<$t> {
                Some(<$t>::MIN)
            }
            fn max_value() -> Option<$t> {
                Some(<$t>::MAX)
            }
            constants!($t; pi = PI, two_pi = TAU, frac_pi_2 = FRAC_PI_2, frac_pi_3 = FRAC_PI_3, frac_pi_4 = FRAC_PI_4,
                frac_pi_6 = FRAC_PI_6, frac_pi_8 = FRAC_PI_8, frac_1_pi = FRAC_1_PI, frac_2_pi = FRAC_2_PI,
                frac_2_sqrt_pi = FRAC_2_SQRT_PI, e = E, log2_e = LOG2_E, log10_e = LOG10_E, ln_2 = LN_2,
                ln_10 = LN_10);
        }
    };
}

/// The inclusions nalgebra converts along. As in simba they stand for "both are reals": nothing is ever outside.
macro_rules! subset_glue {
    ($t:ty; $($subset:ty => $up:expr, $down:expr);*) => {$(
        impl simba::scalar::SubsetOf<$t> for $subset {
            #[inline(always)]
            fn to_superset(&self) -> $t {
                $up(*self)
            }
            #[inline(always)]
            fn from_superset_unchecked(element: &$t) -> $subset {
                $down(*element)
            }
            #[inline(always)]
            fn is_in_subset(_: &$t) -> bool {
                true
            }
        }
    )*};
}

float_glue!(crate::DoubleDouble);
