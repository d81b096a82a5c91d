//! Sine, cosine, tangent.
//!
//! After the reduction modulo π/2, r = j/32 + t with |t| ≤ 1/64, and the addition theorems with a table of
//! (sin, cos)(j/32) [QD, with this table]. They are arranged so that only small terms are multiplied:
//! sin r = S + (C sin t + S (cos t − 1)).

use super::reduction::reduce;
use super::tables::{INVERSE_FACTORIAL, SIN_COS};
use crate::double_double::number::DoubleDouble;
use crate::double_double::transforms::nearest;

/// (sin t, cos t − 1) for |t| ≤ 1/64; the terms from t⁹ and t⁸ on in `f64`.
#[inline(always)]
fn small(t: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let square = t.times(t);
    let x = square.hi;
    let f = |k: usize| INVERSE_FACTORIAL[k].hi;
    let tail = x * (f(9) - x * (f(11) - x * f(13)));
    let sum = (-INVERSE_FACTORIAL[7]).plus_double(tail);
    let sum = INVERSE_FACTORIAL[5].plus(sum.times(square));
    let sum = (-INVERSE_FACTORIAL[3]).plus(sum.times(square));
    let sin = t.plus(sum.times(square).times(t));
    let tail = x * (f(8) - x * (f(10) - x * f(12)));
    let sum = (-INVERSE_FACTORIAL[6]).plus_double(tail);
    let sum = INVERSE_FACTORIAL[4].plus(sum.times(square));
    let cos_m1 = sum.times(square).plus_double(-0.5).times(square);
    (sin, cos_m1)
}

/// (sin r, cos r) for |r| ≤ π/4.
#[inline(always)]
fn kernel(r: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let j = nearest(32.0 * r.hi.abs());
    let (s, c) = SIN_COS[j as usize];
    let negative = r.hi < 0.0;
    let t = (if negative { -r } else { r }).plus_double(-j / 32.0);
    let (sin_t, cos_m1) = small(t);
    let cos = c.plus(c.times(cos_m1).plus(-s.times(sin_t)));
    let sin = if j == 0.0 {
        sin_t
    } else {
        s.plus(c.times(sin_t).plus(s.times(cos_m1)))
    };
    (if negative { -sin } else { sin }, cos)
}

impl DoubleDouble {
    /// (sin x, cos x) at the cost of one.
    #[inline]
    pub fn sin_cos(self) -> (Self, Self) {
        if self.hi.abs() < 1e-33 {
            return (self, Self::ONE);
        }
        if !self.is_finite() {
            return (Self::NAN, Self::NAN);
        }
        let (quadrant, r) = reduce(self);
        let (s, c) = kernel(r);
        match quadrant {
            0 => (s, c),
            1 => (c, -s),
            2 => (-s, -c),
            _ => (-c, s),
        }
    }

    /// Sine of x in radians.
    #[inline]
    pub fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// Cosine of x in radians.
    #[inline]
    pub fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// Tangent of x in radians.
    pub fn tan(self) -> Self {
        if self.hi.abs() < 1e-33 {
            return self;
        }
        let (s, c) = self.sin_cos();
        s / c
    }
}
