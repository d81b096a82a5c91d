//! The part of the glue for num-traits.

macro_rules! num_traits_glue {
    ([$($g:tt)*] $t:ty) => {
        impl<$($g)*> ::num_traits::Zero for $t {
            #[inline(always)]
            fn zero() -> $t {
                <$t>::small(0.0)
            }
            #[inline(always)]
            fn is_zero(&self) -> bool {
                *self == <$t>::small(0.0)
            }
        }
        impl<$($g)*> ::num_traits::One for $t {
            #[inline(always)]
            fn one() -> $t {
                <$t>::small(1.0)
            }
        }
        impl<$($g)*> ::num_traits::Num for $t {
            type FromStrRadixErr = $crate::ParseFloatError;
            /// Decimals only.
            fn from_str_radix(text: &str, radix: u32) -> Result<$t, $crate::ParseFloatError> {
                if radix == 10 { text.parse() } else { Err($crate::ParseFloatError { text: text.into() }) }
            }
        }
        impl<$($g)*> ::num_traits::Inv for $t {
            type Output = $t;
            #[inline(always)]
            fn inv(self) -> $t {
                <$t>::recip(self)
            }
        }
        impl<$($g)*> ::num_traits::Bounded for $t {
            constants!($t; max_value = MAX);
            fn min_value() -> $t {
                -<$t>::MAX
            }
        }
        impl<$($g)*> ::num_traits::FromPrimitive for $t {
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
        impl<$($g)*> ::num_traits::ToPrimitive for $t {
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
        impl<$($g)*> ::num_traits::NumCast for $t {
            /// Floats through `f64`; integers beyond 2⁵³ whole.
            fn from<N: ::num_traits::ToPrimitive>(n: N) -> Option<$t> {
                let double = n.to_f64()?;
                let integer = if double.abs() < 9e15 { None } else { n.to_i128() };
                Some(integer.map_or(<$t as From<f64>>::from(double), <$t>::from_i128))
            }
        }
        impl<$($g)*> ::num_traits::Signed for $t {
            forward!($t, reference: abs, signum);
            fn abs_sub(&self, other: &$t) -> $t {
                <$t>::max(*self - *other, <$t>::small(0.0))
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
        impl<$($g)*> ::num_traits::Float for $t {
            constants!($t; nan = NAN, infinity = INFINITY, max_value = MAX, min_positive_value = MIN_POSITIVE,
                epsilon = EPSILON);
            fn neg_infinity() -> $t {
                -<$t>::INFINITY
            }
            fn min_value() -> $t {
                -<$t>::MAX
            }
            fn neg_zero() -> $t {
                -<$t>::small(0.0)
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
                <$t>::max(self - other, <$t>::small(0.0))
            }
            /// Of the nearest double.
            fn integer_decode(self) -> (u64, i16, i8) {
                ::num_traits::Float::integer_decode(<$t>::hi(self))
            }
        }
    };
}
