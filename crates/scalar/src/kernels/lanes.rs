//! [`Lanes`]: N numbers that undergo the same operations.
//!
//! All operations apply the functions of the number lane by lane, so each lane has the bits of a computation
//! with that number alone. With doubles, arithmetic, √, |x|, min, max and the selections of [`Scalar`] become
//! vector instructions inside a [`Kernel`](crate::Kernel); the other elementary functions are N calls (`sin`
//! over 8 lanes: 68 ns).

use crate::constant::Constant;
use crate::traits::half_power::{by_squares, half_power, half_power_derivative};
use crate::traits::{Float, Outside, Pack, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// N numbers, doubles if nothing else is said, usually one for each stage of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub struct Lanes<const N: usize, T = f64>(pub [T; N]);

// Macros: closures are not always inlined.
macro_rules! each_lane {
    (|$x:ident| $result:expr) => {{
        let mut lanes = $x.0;
        for k in 0..N {
            let $x = $x.0[k];
            lanes[k] = $result;
        }
        Lanes(lanes)
    }};
    (|$x:ident, $y:ident| $result:expr) => {{
        let mut lanes = $x.0;
        for k in 0..N {
            let ($x, $y) = ($x.0[k], $y.0[k]);
            lanes[k] = $result;
        }
        Lanes(lanes)
    }};
}

impl<T: Copy, const N: usize> Lanes<N, T> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(x: T) -> Self {
        Lanes([x; N])
    }
}

impl<const N: usize> Lanes<N> {
    /// self·x + sum, rounded once.
    #[inline(always)]
    pub(crate) fn fused(self, x: f64, sum: Self) -> Self {
        let a = self;
        each_lane!(|a, sum| a.mul_add(x, sum))
    }
}

macro_rules! operators {
    ($($op:ident $f:ident),*) => {$(
        impl<T: Float, const N: usize> $op for Lanes<N, T> {
            type Output = Self;
            #[inline(always)]
            fn $f(self, other: Self) -> Self {
                let x = self;
                each_lane!(|x, other| x.$f(other))
            }
        }
    )*};
}
operators!(Add add, Sub sub, Mul mul, Div div);

impl<T: Float, const N: usize> Neg for Lanes<N, T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let x = self;
        each_lane!(|x| -x)
    }
}

macro_rules! unary {
    ($($f:ident),*) => {$(
        #[inline(always)]
        fn $f(x: Self) -> Self {
            each_lane!(|x| <T as Scalar>::$f(x))
        }
    )*};
}

macro_rules! binary {
    ($($f:ident),*) => {$(
        #[inline(always)]
        fn $f(x: Self, y: Self) -> Self {
            each_lane!(|x, y| <T as Scalar>::$f(x, y))
        }
    )*};
}

impl<T: Float, const N: usize> Scalar for Lanes<N, T> {
    #[inline(always)]
    fn constant(c: Constant) -> Self {
        Lanes::splat(c.to())
    }

    /// Of doubles squaring and multiplying from the lowest bit of |n| upwards, as `f64::powi` does.
    #[inline(always)]
    fn powi(x: Self, n: i32) -> Self {
        match n {
            _ if const { !T::IS_DOUBLE } => return each_lane!(|x| <T as Scalar>::powi(x, n)),
            // Without the loop, which the compiler does not always unroll: a chain's gradient takes three
            // quarters of the time.
            3 => return x * (x * x),
            4 => return (x * x) * (x * x),
            5 => return x * ((x * x) * (x * x)),
            6 => return (x * x) * ((x * x) * (x * x)),
            _ => {}
        }
        let power = by_squares(x, n.unsigned_abs()).unwrap_or(Lanes::splat(T::int(1)));
        if n < 0 { Self::recip(power) } else { power }
    }

    #[inline(always)]
    fn powf(x: Self, c: Constant) -> Self {
        match c.halves::<T>() {
            Some(n) => half_power(x, n),
            None => each_lane!(|x| <T as Scalar>::powf(x, c)),
        }
    }

    #[inline(always)]
    fn outside(f: &Arc<dyn Outside>, orders: [u8; 2], [x, y]: [Self; 2]) -> Self {
        let mut results = x.0;
        let doubles = (T::as_doubles(&x.0), T::as_doubles(&y.0));
        match (doubles, T::as_doubles_mut(&mut results)) {
            ((Some(x), Some(y)), Some(results)) => f.derivatives(orders, [x, y], results),
            _ => return each_lane!(|x, y| T::outside(f, orders, [x, y])),
        }
        Lanes(results)
    }

    unary!(
        recip, sqrt, cbrt, exp, exp2, ln, exp_m1, ln_1p, sin, cos, tan, asin, acos, atan, sinh,
        cosh, tanh, asinh, acosh, atanh, erf, erfc, abs, signum
    );
    binary!(pow, atan2, hypot, min, max, at_most, where_nonzero);
    #[inline(always)]
    fn powf_derivative(x: Self, power: Self, c: Constant) -> Self {
        match c.halves::<T>() {
            Some(n) => half_power_derivative(x, power, n),
            None => each_lane!(|x, power| T::powf_derivative(x, power, c)),
        }
    }
}

impl<T: Float, const N: usize> Lanes<N, T> {
    /// As [`Float::two_sum`].
    #[inline(always)]
    fn two_sum(a: Self, b: Self) -> (Self, Self) {
        // Operation by operation: of lanes that are gone through one by one the compiler does not always make
        // vectors.
        let sum = a + b;
        let b_part = sum - a;
        (sum, (a - (sum - b_part)) + (b - b_part))
    }
}

impl<T: Float, const N: usize> Pack<T, N> for Lanes<N, T> {
    #[inline(always)]
    fn splat(x: T) -> Self {
        Lanes::splat(x)
    }

    #[inline(always)]
    fn of(from: &[T; N]) -> Self {
        Lanes(*from)
    }

    #[inline(always)]
    fn numbers(self) -> [T; N] {
        self.0
    }

    #[inline(always)]
    fn heads(self) -> [f64; N] {
        self.0.map(T::to_f64)
    }

    #[inline(always)]
    fn total(packs: &[[T; N]]) -> (T, T) {
        let (mut sum, mut lost) = (Lanes(packs[0]), Self::splat(T::int(0)));
        for &x in &packs[1..] {
            let (s, e) = Self::two_sum(sum, Lanes(x));
            (sum, lost) = (s, lost + e);
        }
        // By numbers: lanes that are shifted go through memory, where what is read across what was just
        // written is waited for, a third of a step of long chains.
        let (mut sum, mut lost) = (sum.0, lost.0);
        let mut count = N;
        while count > 1 {
            let half = count.div_ceil(2);
            for i in 0..count - half {
                let (s, e) = Lanes::two_sum(Lanes([sum[i]]), Lanes([sum[i + half]]));
                (sum[i], lost[i]) = (s.0[0], (lost[i] + lost[i + half]) + e.0[0]);
            }
            count = half;
        }
        (sum[0], lost[0])
    }
}
