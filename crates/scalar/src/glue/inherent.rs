//! Functions of `f64`, by its names, that are the same for every float: signs, selections, rounding, units of
//! angles.

/// Of a type with `floor`, `signum`, `small`, `is_nan`, `is_sign_negative` and `ln`.
macro_rules! inherent_glue {
    ([$($g:tt)*] $t:ty) => {
        impl<$($g)*> $t {
            /// |x|.
            #[inline(always)]
            pub fn abs(self) -> Self {
                if self.is_sign_negative() { -self } else { self }
            }

            /// Whether the sign bit is clear.
            #[inline(always)]
            pub fn is_sign_positive(self) -> bool {
                !self.is_sign_negative()
            }

            /// |x| with the sign of `sign`.
            pub fn copysign(self, sign: Self) -> Self {
                if self.is_sign_negative() == sign.is_sign_negative() { self } else { -self }
            }

            /// The smaller of two; a NaN is ignored.
            #[inline(always)]
            pub fn min(self, other: Self) -> Self {
                if self <= other || other.is_nan() { self } else { other }
            }

            /// The larger of two; a NaN is ignored.
            #[inline(always)]
            pub fn max(self, other: Self) -> Self {
                if self >= other || other.is_nan() { self } else { other }
            }

            /// The smallest integer not below the number.
            pub fn ceil(self) -> Self {
                -(-self).floor()
            }

            /// The integer part.
            pub fn trunc(self) -> Self {
                if self.is_sign_negative() { self.ceil() } else { self.floor() }
            }

            /// What [`trunc`](Self::trunc) takes away.
            pub fn fract(self) -> Self {
                self - self.trunc()
            }

            /// The nearest integer, half-way cases away from zero.
            pub fn round(self) -> Self {
                let whole = self.trunc();
                if (self - whole).abs() >= Self::small(0.5) { whole + self.signum() } else { whole }
            }

            /// 1/x.
            #[inline]
            pub fn recip(self) -> Self {
                Self::small(1.0) / self
            }

            /// Logarithm to any base.
            pub fn log(self, base: Self) -> Self {
                self.ln() / base.ln()
            }

            /// Degrees to radians.
            pub fn to_radians(self) -> Self {
                self * (<Self as ::num_traits::FloatConst>::PI() / Self::small(180.0))
            }

            /// Radians to degrees.
            pub fn to_degrees(self) -> Self {
                self * (Self::small(180.0) / <Self as ::num_traits::FloatConst>::PI())
            }
        }
    };
}
