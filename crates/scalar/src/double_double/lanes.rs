//! [`DoubleDoubles`]: N double-doubles that undergo the same operations.
//!
//! Upper and lower words are in separate [`Lanes`]. Inside a [`Kernel`](crate::Kernel), arithmetic, √, |x|
//! and integer powers are vector instructions without branches. One test per result detects infinities, NaN
//! and numbers near the limits of the exponent in any lane; every lane is then computed as a
//! [`DoubleDouble`]. Each lane therefore has the bits of the single number. Other elementary functions are N
//! calls.

use super::number::{DoubleDouble, dd};
use super::transforms::{SAFE_MAX, SAFE_MIN, Word};
use super::words::{self, Dot, Pair, Sum};
use crate::constant::Constant;
use crate::kernels::Lanes;
use crate::traits::half_power::{by_squares, half_power, half_power_derivative};
use crate::traits::{Outside, Pack, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// N double-doubles, usually one for each stage of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleDoubles<const N: usize> {
    hi: Lanes<N>,
    lo: Lanes<N>,
}

impl<const N: usize> DoubleDoubles<N> {
    #[inline(always)]
    fn joined((hi, lo): Pair<Lanes<N>>) -> Self {
        DoubleDoubles { hi, lo }
    }

    #[inline(always)]
    fn words(self) -> Pair<Lanes<N>> {
        (self.hi, self.lo)
    }

    /// Whether an infinity, a NaN or an overflow took part.
    #[inline(always)]
    fn is_special(&self) -> bool {
        let mut any = false;
        for k in 0..N {
            any |= self.lo.0[k].is_nan();
        }
        any
    }
}

#[cold]
#[inline(never)]
fn one_by_one<const N: usize>(
    x: &DoubleDoubles<N>,
    y: &DoubleDoubles<N>,
    f: fn(DoubleDouble, DoubleDouble) -> DoubleDouble,
) -> DoubleDoubles<N> {
    let (mut x, y) = (x.numbers(), y.numbers());
    for k in 0..N {
        x[k] = f(x[k], y[k]);
    }
    DoubleDoubles::of(&x)
}

#[inline(never)]
fn each<const N: usize>(
    x: &DoubleDoubles<N>,
    f: impl Fn(DoubleDouble) -> DoubleDouble,
) -> DoubleDoubles<N> {
    DoubleDoubles::of(&x.numbers().map(f))
}

impl<const N: usize> Add for DoubleDoubles<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let sum = Self::joined(words::plus(self.words(), other.words()));
        if sum.is_special() {
            return one_by_one(&self, &other, |x, y| x + y);
        }
        sum
    }
}

impl<const N: usize> Sub for DoubleDoubles<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + (-other)
    }
}

impl<const N: usize> Neg for DoubleDoubles<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::joined((-self.hi, -self.lo))
    }
}

impl<const N: usize> Mul for DoubleDoubles<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let product = Self::joined(words::times(self.words(), other.words()));
        if product.is_special() {
            return one_by_one(&self, &other, |x, y| x * y);
        }
        product
    }
}

impl<const N: usize> Div for DoubleDoubles<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = Self::joined(words::over(self.words(), other.words()));
        let mut small = false;
        for x in self.hi.0 {
            small |= x.abs() < SAFE_MIN;
        }
        if small || quotient.is_special() {
            return one_by_one(&self, &other, |x, y| x / y);
        }
        quotient
    }
}

macro_rules! unary {
    ($($f:ident),*) => {$(
        #[inline(always)]
        fn $f(x: Self) -> Self {
            each(&x, DoubleDouble::$f)
        }
    )*};
}

macro_rules! binary {
    ($($f:ident),*) => {$(
        #[inline(always)]
        fn $f(x: Self, y: Self) -> Self {
            one_by_one(&x, &y, <DoubleDouble as Scalar>::$f)
        }
    )*};
}

impl<const N: usize> Scalar for DoubleDoubles<N> {
    #[inline(always)]
    fn constant(c: Constant) -> Self {
        Self::splat(c.to())
    }

    #[inline(always)]
    fn recip(x: Self) -> Self {
        Self::splat(DoubleDouble::ONE) / x
    }

    #[inline(always)]
    fn sqrt(x: Self) -> Self {
        let mut ordinary = true;
        for x in x.hi.0 {
            ordinary &= (SAFE_MIN..SAFE_MAX).contains(&x);
        }
        if ordinary {
            Self::joined(words::root(x.words(), Lanes::sqrt(x.hi)))
        } else {
            each(&x, DoubleDouble::sqrt)
        }
    }

    /// By the multiplications of `DoubleDouble::powi`.
    #[inline(always)]
    fn powi(x: Self, n: i32) -> Self {
        if n < 0 {
            return each(&x, |x| x.powi(n));
        }
        by_squares(x, n.unsigned_abs()).unwrap_or(Self::splat(DoubleDouble::ONE))
    }

    #[inline(always)]
    fn powf(x: Self, c: Constant) -> Self {
        match c.halves::<DoubleDouble>() {
            Some(n) => half_power(x, n),
            None => each(&x, |x| Scalar::powf(x, c)),
        }
    }

    #[inline(always)]
    fn abs(x: Self) -> Self {
        let mut result = x;
        for k in 0..N {
            let negative = x.hi.0[k].is_sign_negative();
            result.hi.0[k] = x.hi.0[k].abs();
            result.lo.0[k] = if negative { -x.lo.0[k] } else { x.lo.0[k] };
        }
        result
    }

    #[inline(always)]
    fn signum(x: Self) -> Self {
        let [one, minus_one] = [1, -1].map(DoubleDouble::from_i64);
        let mut result = x;
        for k in 0..N {
            let x = dd(x.hi.0[k], x.lo.0[k]);
            let other = if x.hi < 0.0 { minus_one } else { x };
            let sign = if x.hi > 0.0 { one } else { other };
            (result.hi.0[k], result.lo.0[k]) = (sign.hi, sign.lo);
        }
        result
    }

    #[inline(always)]
    fn at_most(x: Self, y: Self) -> Self {
        let mut result = [0.0; N];
        for (k, result) in result.iter_mut().enumerate() {
            let below = x.hi.0[k] < y.hi.0[k];
            let equal = x.hi.0[k] == y.hi.0[k];
            let is_at_most = below | (equal & (x.lo.0[k] <= y.lo.0[k]));
            *result = if is_at_most { 1.0 } else { 0.0 };
        }
        Self::joined((Lanes(result), Lanes::splat(0.0)))
    }

    #[inline(always)]
    fn where_nonzero(x: Self, test: Self) -> Self {
        let zero = Lanes::splat(0.0);
        Self::joined((
            x.hi.unless_zero(test.hi, zero),
            x.lo.unless_zero(test.hi, zero),
        ))
    }

    #[inline(always)]
    fn powf_derivative(x: Self, power: Self, c: Constant) -> Self {
        if let Some(n) = c.halves::<DoubleDouble>() {
            return half_power_derivative(x, power, n);
        }
        let (x, mut power) = (x.numbers(), power.numbers());
        for k in 0..N {
            power[k] = Scalar::powf_derivative(x[k], power[k], c);
        }
        Self::of(&power)
    }

    #[inline(always)]
    fn outside(f: &Arc<dyn Outside>, orders: [u8; 2], [x, y]: [Self; 2]) -> Self {
        let (x, y) = (x.numbers(), y.numbers());
        Self::of(&std::array::from_fn(|k| {
            Scalar::outside(f, orders, [x[k], y[k]])
        }))
    }

    unary!(
        cbrt, exp, exp2, ln, exp_m1, ln_1p, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh,
        asinh, acosh, atanh, erf, erfc
    );
    binary!(pow, atan2, hypot, min, max);
}

impl<const N: usize> Pack<DoubleDouble, N> for DoubleDoubles<N> {
    #[inline(always)]
    fn splat(x: DoubleDouble) -> Self {
        Self::joined((Lanes::splat(x.hi), Lanes::splat(x.lo)))
    }

    #[inline(always)]
    fn of(from: &[DoubleDouble; N]) -> Self {
        let (mut hi, mut lo) = ([0.0; N], [0.0; N]);
        for k in 0..N {
            (hi[k], lo[k]) = (from[k].hi, from[k].lo);
        }
        Self::joined((Lanes(hi), Lanes(lo)))
    }

    #[inline(always)]
    fn numbers(self) -> [DoubleDouble; N] {
        let mut numbers = [DoubleDouble::ZERO; N];
        for (k, number) in numbers.iter_mut().enumerate() {
            *number = dd(self.hi.0[k], self.lo.0[k]);
        }
        numbers
    }

    #[inline(always)]
    fn heads(self) -> [f64; N] {
        self.hi.0
    }

    #[inline(always)]
    fn total(packs: &[[DoubleDouble; N]]) -> (DoubleDouble, DoubleDouble) {
        let mut sum = Sum::of(Self::of(&packs[0]).words());
        for x in &packs[1..] {
            sum = sum.plus(Sum::of(Self::of(x).words()));
        }
        let sum = if N == 8 {
            folded::<2, 1>(folded::<4, 2>(folded::<N, 4>(sum))).lane(0)
        } else {
            (1..N).fold(sum.lane(0), |all, k| all.plus(sum.lane(k)))
        };
        let ((hi, lo), rest) = sum.total();
        // A NaN is there if an infinity or an overflow took part.
        if !(lo + rest).is_nan() {
            (dd(hi, lo), dd(rest, 0.0))
        } else {
            special_total(packs)
        }
    }

    #[inline(always)]
    fn dot(a: impl Fn(usize) -> Self, b: &[DoubleDouble]) -> Self {
        let mut dot = Dot::new();
        for (j, &b) in b.iter().enumerate() {
            dot.add(a(j).words(), Self::splat(b).words());
        }
        let total = Self::joined(dot.total());
        if total.is_special() {
            return special_dot(a, b);
        }
        total
    }
}

#[cold]
#[inline(never)]
fn special_dot<const N: usize>(
    a: impl Fn(usize) -> DoubleDoubles<N>,
    b: &[DoubleDouble],
) -> DoubleDoubles<N> {
    let mut sums = [DoubleDouble::ZERO; N];
    for (j, &b) in b.iter().enumerate() {
        for (sum, a) in sums.iter_mut().zip(a(j).numbers()) {
            *sum += a * b;
        }
    }
    DoubleDoubles::of(&sums)
}

impl<const N: usize> Sum<Lanes<N>> {
    #[inline(always)]
    fn lane(self, k: usize) -> Sum<f64> {
        Sum {
            words: self.words.map(|word| word.0[k]),
        }
    }
}

/// The first H lanes plus the next.
#[inline(always)]
fn folded<const N: usize, const H: usize>(sum: Sum<Lanes<N>>) -> Sum<Lanes<H>> {
    let mut halves = [sum.words.map(|_| Lanes::splat(0.0)); 2];
    for (at, half) in halves.iter_mut().enumerate() {
        for (half, word) in half.iter_mut().zip(&sum.words) {
            half.0.copy_from_slice(&word.0[at * H..(at + 1) * H]);
        }
    }
    let [first, last] = halves.map(|words| Sum { words });
    first.plus(last)
}

#[cold]
#[inline(never)]
fn special_total<const N: usize>(packs: &[[DoubleDouble; N]]) -> (DoubleDouble, DoubleDouble) {
    let numbers = packs.as_flattened().iter();
    let sum = numbers.fold(DoubleDouble::ZERO, |sum, &x| sum + x);
    (sum, DoubleDouble::ZERO)
}

impl<const N: usize> Word for Lanes<N> {
    #[inline(always)]
    fn word(x: f64) -> Self {
        Lanes::splat(x)
    }

    /// A vector instruction inside a kernel for AVX2 or AVX-512, elsewhere N calls.
    #[inline(always)]
    fn product_rest(a: Self, b: Self, p: Self) -> Self {
        let mut rest = p;
        for k in 0..N {
            rest.0[k] = a.0[k].mul_add(b.0[k], -p.0[k]);
        }
        rest
    }

    #[inline(always)]
    fn unless_zero(mut self, test: Self, other: Self) -> Self {
        for k in 0..N {
            self.0[k] = self.0[k].unless_zero(test.0[k], other.0[k]);
        }
        self
    }
}
