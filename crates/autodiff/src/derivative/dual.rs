//! [`Dual`]: a number with N first derivatives, for floats and for lanes alike.
//!
//! The gradient of the trait route: each variable carries its own unit vector, each operation applies the
//! chain rule. The value has every bit of the float's own function. Which variables a number does not depend
//! on is known when it is compiled, so constants, the other coordinates, and momenta when only forces are
//! asked for, cost nothing.
//!
//! At kinks as on the tape. √, powers and quotients of zero: a slope that is infinite times a rate
//! that is exactly 0 is 0.

use equip_scalar::{Constant, DoubleDouble, Outside, Piecewise, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

/// Rates one by one, as macros: closures are not always inlined.
macro_rules! each_rate {
    ($x:expr, |$rate:ident| $result:expr) => {{
        let mut rates = $x;
        for k in 0..N {
            if rates.has(k) {
                let $rate = rates.of[k];
                rates.of[k] = $result;
            }
        }
        rates
    }};
}

/// Rates of change with the variables, and a bit for each variable that there is one of; the others are zero.
/// The compiler knows the bits before it takes the loops apart; of `Option`s in memory it takes no long loop
/// apart at all.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rates<S, const N: usize> {
    of: [S; N],
    variables: u32,
}

impl<S: Piecewise, const N: usize> Rates<S, N> {
    #[inline(always)]
    fn none() -> Self {
        Rates {
            of: [number(0.0); N],
            variables: 0,
        }
    }

    #[inline(always)]
    fn has(&self, k: usize) -> bool {
        (self.variables >> k) & 1 == 1
    }
}

/// value + Σ ε_k rates_k.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dual<S, const N: usize> {
    pub(crate) value: S,
    rates: Rates<S, N>,
}

impl<S: Piecewise, const N: usize> Dual<S, N> {
    #[inline(always)]
    pub(crate) fn fixed(value: S) -> Self {
        Dual {
            value,
            rates: Rates::none(),
        }
    }

    /// The independent variable number `index`.
    #[inline(always)]
    pub(crate) fn variable(value: S, index: usize) -> Self {
        let mut rates = Rates::none();
        rates.of[index] = number(1.0);
        rates.variables = 1 << index;
        Dual { value, rates }
    }

    /// The derivatives.
    #[inline(always)]
    pub(crate) fn gradient(self) -> [S; N] {
        self.rates.of
    }

    #[inline(always)]
    fn chain(self, f: S, slope: S) -> Self {
        Dual {
            value: f,
            rates: each_rate!(self.rates, |rate| slope * rate),
        }
    }

    /// For slopes that may be infinite where the rates are 0.
    #[inline(always)]
    fn chain_singular(self, f: S, slope: S) -> Self {
        if S::is_regular(slope) {
            self.chain(f, slope)
        } else {
            Dual {
                value: f,
                rates: each_rate!(self.rates, |rate| S::times_slope(rate, slope)),
            }
        }
    }

    #[inline(always)]
    fn chain2(self, other: Self, f: S, by_x: S, by_y: S) -> Self {
        let x = each_rate!(self.rates, |rate| by_x * rate);
        let y = each_rate!(other.rates, |rate| by_y * rate);
        Dual {
            value: f,
            rates: sum(x, y),
        }
    }
}

#[inline(always)]
fn number<S: Scalar>(x: f64) -> S {
    S::constant(Constant::double(x))
}

#[inline(always)]
fn wide<S: Scalar>(x: DoubleDouble) -> S {
    S::constant(Constant::from(x))
}

#[inline(always)]
fn sum<S: Piecewise, const N: usize>(x: Rates<S, N>, y: Rates<S, N>) -> Rates<S, N> {
    let mut sums = x;
    for k in 0..N {
        if y.has(k) {
            sums.of[k] = if x.has(k) { x.of[k] + y.of[k] } else { y.of[k] };
        }
    }
    sums.variables |= y.variables;
    sums
}

impl<S: Piecewise, const N: usize> Add for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Dual {
            value: self.value + other.value,
            rates: sum(self.rates, other.rates),
        }
    }
}

impl<S: Piecewise, const N: usize> Sub for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Dual {
            value: self.value - other.value,
            rates: sum(self.rates, each_rate!(other.rates, |rate| -rate)),
        }
    }
}

impl<S: Piecewise, const N: usize> Mul for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.chain2(other, self.value * other.value, other.value, self.value)
    }
}

impl<S: Piecewise, const N: usize> Div for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let f = self.value / other.value;
        // Not through f: where only the derivatives are used, the second division falls away.
        let slope = S::recip(other.value);
        self.chain2(other, f, slope, -(self.value * slope * slope))
    }
}

impl<S: Piecewise, const N: usize> Neg for Dual<S, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual {
            value: -self.value,
            rates: each_rate!(self.rates, |rate| -rate),
        }
    }
}

macro_rules! functions {
    ($($name:ident: |$x:ident, $f:ident| $slope:expr;)*) => {$(
        #[inline(always)]
        fn $name(x: Self) -> Self {
            let $x = x.value;
            let $f = S::$name($x);
            x.chain($f, $slope)
        }
    )*};
}

impl<S: Piecewise, const N: usize> Scalar for Dual<S, N> {
    #[inline(always)]
    fn constant(c: Constant) -> Self {
        Dual::fixed(S::constant(c))
    }

    #[inline(always)]
    fn sqrt(x: Self) -> Self {
        let f = S::sqrt(x.value);
        // The reciprocal is the one of a following 1/√x.
        x.chain_singular(f, number::<S>(0.5) * S::recip(f))
    }

    #[inline(always)]
    fn powi(x: Self, n: i32) -> Self {
        let factor = number::<S>(f64::from(n));
        let f = S::powi(x.value, n);
        match n {
            0 => Dual::fixed(f),
            1 => x,
            2 => x.chain(f, x.value + x.value),
            3.. => x.chain(f, factor * S::powi(x.value, n - 1)),
            _ => x.chain_singular(f, factor * (f / x.value)),
        }
    }

    #[inline(always)]
    fn powf(x: Self, c: Constant) -> Self {
        let f = S::powf(x.value, c);
        x.chain_singular(f, S::powf_slope(x.value, f, c))
    }

    #[inline(always)]
    fn pow(x: Self, y: Self) -> Self {
        let f = S::pow(x.value, y.value);
        let by_x = S::where_nonzero(y.value * S::pow(x.value, y.value - number(1.0)), y.value);
        let by_y = S::where_nonzero(f * S::ln(x.value), f);
        let rates_x = each_rate!(x.rates, |rate| S::times_slope(rate, by_x));
        let rates_y = each_rate!(y.rates, |rate| S::times_slope(rate, by_y));
        Dual {
            value: f,
            rates: sum(rates_x, rates_y),
        }
    }

    /// Divided by the radius twice, where its square could overflow.
    #[inline(always)]
    fn atan2(y: Self, x: Self) -> Self {
        let r = S::hypot(x.value, y.value);
        let f = S::atan2(y.value, x.value);
        y.chain2(x, f, x.value / r / r, -(y.value / r / r))
    }

    #[inline(always)]
    fn hypot(x: Self, y: Self) -> Self {
        let f = S::hypot(x.value, y.value);
        let by_x = S::where_nonzero(x.value / f, f);
        x.chain2(y, f, by_x, S::where_nonzero(y.value / f, f))
    }

    #[inline(always)]
    fn min(x: Self, y: Self) -> Self {
        let first = S::at_most(x.value, y.value);
        x.chain2(y, S::min(x.value, y.value), first, number::<S>(1.0) - first)
    }

    #[inline(always)]
    fn max(x: Self, y: Self) -> Self {
        let first = S::at_most(y.value, x.value);
        x.chain2(y, S::max(x.value, y.value), first, number::<S>(1.0) - first)
    }

    #[inline(always)]
    fn signum(x: Self) -> Self {
        Dual::fixed(S::sign(x.value))
    }

    #[inline(always)]
    fn select(test: Self, at_least_zero: Self, below: Self) -> Self {
        let is_taken = S::at_most(number(0.0), test.value);
        let rest = number::<S>(1.0) - is_taken;
        let of_taken = each_rate!(at_least_zero.rates, |rate| S::where_nonzero(rate, is_taken));
        let of_other = each_rate!(below.rates, |rate| S::where_nonzero(rate, rest));
        Dual {
            value: S::by_sign(test.value, at_least_zero.value, below.value),
            rates: sum(of_taken, of_other),
        }
    }

    #[inline(always)]
    fn outside(f: &Arc<dyn Outside>, [i, j]: [u8; 2], [x, y]: [Self; 2]) -> Self {
        let derivative = |i, j| S::outside(f, [i, j], [x.value, y.value]);
        let (value, by_x) = (derivative(i, j), derivative(i + 1, j));
        if f.variables() == 1 {
            x.chain(value, by_x)
        } else {
            x.chain2(y, value, by_x, derivative(i, j + 1))
        }
    }

    functions! {
        recip: |_x, f| -(f * f);
        exp: |_x, f| f;
        ln: |x, _f| S::recip(x);
        exp_m1: |x, _f| S::exp(x);
        ln_1p: |x, _f| S::recip(number::<S>(1.0) + x);
        sin: |x, _f| S::cos(x);
        cos: |x, _f| -S::sin(x);
        tan: |_x, f| number::<S>(1.0) + f * f;
        asin: |x, _f| S::recip(S::sqrt((number::<S>(1.0) - x) * (number::<S>(1.0) + x)));
        acos: |x, _f| -S::recip(S::sqrt((number::<S>(1.0) - x) * (number::<S>(1.0) + x)));
        atan: |x, _f| S::recip(number::<S>(1.0) + x * x);
        sinh: |x, _f| S::cosh(x);
        cosh: |x, _f| S::sinh(x);
        // 1/cosh² from e^{−|x|}: 1 − tanh² has no correct digit left from x = 19 on, and cosh overflows.
        tanh: |x, _f| {
            let u = S::exp(-S::abs(x));
            let sech = (u + u) / (number::<S>(1.0) + u * u);
            sech * sech
        };
        cbrt: |_x, f| S::recip(number::<S>(3.0) * (f * f));
        exp2: |_x, f| wide::<S>(DoubleDouble::LN_2) * f;
        asinh: |x, _f| S::recip(S::hypot(x, number(1.0)));
        acosh: |x, _f| S::recip(S::sqrt(x - number(1.0)) * S::sqrt(x + number(1.0)));
        atanh: |x, _f| S::recip((number::<S>(1.0) - x) * (number::<S>(1.0) + x));
        erf: |x, _f| wide::<S>(DoubleDouble::FRAC_2_SQRT_PI) * S::exp(-(x * x));
        erfc: |x, _f| -(wide::<S>(DoubleDouble::FRAC_2_SQRT_PI) * S::exp(-(x * x)));
        abs: |x, _f| S::sign(x);
    }
}
