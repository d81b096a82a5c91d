//! The part of the glue for simba, by which nalgebra accepts the type.

macro_rules! simba_glue {
    ([$($g:tt)*] $t:ty) => {
        impl<$($g)*> ::simba::scalar::Field for $t {}
        impl<$($g)*> ::simba::simd::PrimitiveSimdValue for $t {}
        impl<$($g)*> ::simba::simd::SimdValue for $t {
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
        subset_glue!([$($g)*] $t; $t => |x: $t| x, |x: $t| x; f64 => |x: f64| <$t>::from(x), |x: $t| x.hi();
            f32 => |x: f32| <$t>::from(f64::from(x)), |x: $t| x.hi() as f32);
        impl<$($g)*> ::simba::scalar::ComplexField for $t {
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
                <$t>::small(0.0)
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
                if self >= <$t>::small(0.0) { <$t>::small(0.0) } else { <$t as ::num_traits::FloatConst>::PI() }
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
                if self >= <$t>::small(0.0) { (self, <$t>::small(1.0)) } else { (-self, -<$t>::small(1.0)) }
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
                if self >= <$t>::small(0.0) { Some(<$t>::sqrt(self)) } else { None }
            }
        }
        impl<$($g)*> ::simba::scalar::RealField for $t {
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
                Some(-<$t>::MAX)
            }
            fn max_value() -> Option<$t> {
                Some(<$t>::MAX)
            }
            constants!($t, named; pi = PI, two_pi = TAU, frac_pi_2 = FRAC_PI_2, frac_pi_3 = FRAC_PI_3, frac_pi_4 = FRAC_PI_4,
                frac_pi_6 = FRAC_PI_6, frac_pi_8 = FRAC_PI_8, frac_1_pi = FRAC_1_PI, frac_2_pi = FRAC_2_PI,
                frac_2_sqrt_pi = FRAC_2_SQRT_PI, e = E, log2_e = LOG2_E, log10_e = LOG10_E, ln_2 = LN_2,
                ln_10 = LN_10);
        }
    };
}

/// The inclusions nalgebra converts along. As in simba they stand for "both are reals": nothing is ever
/// outside.
macro_rules! subset_glue {
    ($g:tt $t:ty; $($subset:ty => $up:expr, $down:expr);*) => {$(
        subset_glue!(@one $g $t; $subset => $up, $down);
    )*};
    (@one [$($g:tt)*] $t:ty; $subset:ty => $up:expr, $down:expr) => {
        impl<$($g)*> ::simba::scalar::SubsetOf<$t> for $subset {
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
    };
}
