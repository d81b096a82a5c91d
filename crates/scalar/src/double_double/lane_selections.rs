//! Signs and selections of N double-doubles, and [`Lanes`] as their words.

use crate::constant::Constant;
use crate::double_double::lanes::{DoubleDoubles, one_by_one};
use crate::double_double::number::{DoubleDouble, dd};
use crate::double_double::transforms::Word;
use crate::kernels::Lanes;
use crate::traits::half_power::half_power_derivative;
use crate::traits::{Pack, Piecewise};

impl<const N: usize> Piecewise for DoubleDoubles<N> {
    #[inline(always)]
    fn sign(x: Self) -> Self {
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
    fn times_derivative(rate: Self, derivative: Self) -> Self {
        one_by_one(&rate, &derivative, Piecewise::times_derivative)
    }

    #[inline(always)]
    fn powf_derivative(x: Self, power: Self, c: Constant) -> Self {
        if let Some(n) = c.halves::<DoubleDouble>() {
            return half_power_derivative(x, power, n);
        }
        let (x, mut power) = (x.numbers(), power.numbers());
        for k in 0..N {
            power[k] = Piecewise::powf_derivative(x[k], power[k], c);
        }
        Self::of(&power)
    }

    #[inline(always)]
    fn is_regular(x: Self) -> bool {
        Lanes::is_regular(x.hi)
    }
}

/// N algorithms side by side.
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
