//! The part of the glue for num-dual.

macro_rules! num_dual_glue {
    ([$($g:tt)*] $t:ty) => {
        impl<$($g)*> ::num_dual::DualStruct for $t {
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
        impl<$($g)*> ::num_dual::Mappable<$t> for $t {
            type Output<O> = O;
            #[inline(always)]
            fn map_dual<M: Fn($t) -> O, O>(self, f: M) -> O {
                f(self)
            }
        }
        impl<$($g)*> ::num_dual::DualNum for $t {
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
                if *self == <$t>::small(0.0) { <$t>::small(1.0) } else { <$t>::sin(*self) / *self }
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
                ((three / (x * x) - <$t>::small(1.0)) * s - three * c / x) / x
            }
        }
    };
}
