//! Logarithms and the inverse hyperbolic functions.
//!
//! x = 2ᵉ m, √½ < m ≤ √2; with j the integer next to 32/m, f = m·j/32 − 1 is at most 0.023 and ln x = e ln
//! 2 + ln(32/j) + ln(1 + f) [Tang 1990]; ln(1 + f) = 2 artanh(f/(2 + f)) by its series. Next to 1 the first
//! two terms vanish and full relative precision remains.

use super::tables::{INVERSE_ODD, LN};
use crate::double_double::number::{DoubleDouble, dd};
use crate::double_double::transforms::{nearest, two_prod, two_sum};

/// ln(1 + f) for |f| ≤ 0.023: 2s (1 + s²/3 + s⁴/5 + … + s¹⁸/19), the terms from s⁸ on in `f64`.
#[inline(always)]
fn small_ln_1p(f: DoubleDouble) -> DoubleDouble {
    let s = f.over(f.plus_double(2.0));
    let square = s.times(s);
    let x = square.hi;
    let mut tail = INVERSE_ODD[9].hi;
    for k in (4..9).rev() {
        tail = tail * x + INVERSE_ODD[k].hi;
    }
    let mut sum = INVERSE_ODD[3].plus_double(tail * x);
    for k in (1..3).rev() {
        sum = INVERSE_ODD[k].plus(sum.times(square));
    }
    let twice = dd(2.0 * s.hi, 2.0 * s.lo);
    twice.plus(twice.times(sum.times(square)))
}

/// (e, ln m) with x = 2ᵉ m, for finite x > 0.
#[inline(always)]
fn exponent_and_ln(x: DoubleDouble) -> (i32, DoubleDouble) {
    let mut e = x.exponent();
    let mut m = if e == 0 { x } else { x.scale(-e) };
    if m.hi > std::f64::consts::SQRT_2 {
        m = m.half();
        e += 1;
    }
    let j = nearest(32.0 / m.hi);
    let r = j / 32.0;
    // All parts of m·r − 1: its absolute error is amplified by 1/ln m.
    let (p, q) = two_prod(m.hi, r);
    let (v, w) = two_prod(m.lo, r);
    let (s, t) = two_sum(p - 1.0, q);
    let small = small_ln_1p(dd(s, t).plus_double(v).plus_double(w));
    (
        e,
        if j == 32.0 {
            small
        } else {
            LN[j as usize - 23].plus(small)
        },
    )
}

impl DoubleDouble {
    /// Natural logarithm; −∞ at 0, NaN below.
    pub fn ln(self) -> Self {
        if !(self.hi > 0.0 && self.hi.is_finite()) {
            return self.ln_special();
        }
        let (e, ln) = exponent_and_ln(self);
        if e == 0 {
            ln
        } else {
            Self::LN_2.times_double(f64::from(e)).plus(ln)
        }
    }

    #[cold]
    fn ln_special(self) -> Self {
        match self.hi {
            0.0 => Self::NEG_INFINITY,
            x if x > 0.0 => Self::INFINITY,
            _ => Self::NAN,
        }
    }

    /// ln(1 + x), accurate near 0: u = RN(1 + x), and (1 + x − u)/u adds what the rounding lost.
    pub fn ln_1p(self) -> Self {
        if self.hi.abs() < 1e-33 {
            return self;
        }
        if self.hi.abs() < 0.0155 {
            return small_ln_1p(self);
        }
        let u = self + Self::ONE;
        if !(u.hi > 0.0 && u.hi.is_finite()) {
            return u.ln_special();
        }
        let lost = if self.hi < 1.0 {
            self.plus(-u.plus_double(-1.0))
        } else {
            Self::ONE.plus(-u.plus(-self))
        };
        u.ln().plus_double(lost.hi / u.hi)
    }

    /// Logarithm to base 2; exact for powers of two.
    pub fn log2(self) -> Self {
        if !(self.hi > 0.0 && self.hi.is_finite()) {
            return self.ln_special();
        }
        let (e, ln) = exponent_and_ln(self);
        ln.times(Self::LOG2_E).plus_double(f64::from(e))
    }

    /// Logarithm to base 10.
    pub fn log10(self) -> Self {
        self.ln() * Self::LOG10_E
    }

    /// Inverse hyperbolic sine: ln(1 + (x + x²/(1 + √(1 + x²)))).
    pub fn asinh(self) -> Self {
        let x = self.abs();
        let y = if x.hi < 1e-33 || !x.is_finite() {
            x
        } else if x.hi < 1e100 {
            let square = x.times(x);
            x.plus(square.over(square.plus_double(1.0).sqrt().plus_double(1.0)))
                .ln_1p()
        } else {
            x.ln().plus(Self::LN_2)
        };
        y.copysign(self)
    }

    /// Inverse hyperbolic cosine: ln(1 + (t + √(t(t + 2)))), t = x − 1; NaN below 1.
    pub fn acosh(self) -> Self {
        if self.hi.is_nan() || self < Self::ONE {
            return Self::NAN;
        }
        if self.hi < 1e100 {
            let t = self - Self::ONE;
            return (t + (t * (t + Self::from(2.0))).sqrt()).ln_1p();
        }
        self.ln() + Self::LN_2
    }

    /// Inverse hyperbolic tangent: ½ ln(1 + 2x/(1 − x)); ±∞ at ±1, NaN outside.
    pub fn atanh(self) -> Self {
        let x = self.abs();
        if x.hi < 1e-33 {
            return self;
        }
        ((x + x) / (Self::ONE - x)).ln_1p().half().copysign(self)
    }
}
