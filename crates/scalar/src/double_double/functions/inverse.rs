//! Inverse trigonometric functions.
//!
//! All through atan2: with 0 ≤ y ≤ x and j the integer next to 32 y/x, c = j/32,
//! arctan(y/x) = arctan c + arctan((y − c x)/(x + c y)), the last by its series in t ≤ 1/64.

use super::tables::{ATAN, INVERSE_ODD};
use crate::double_double::number::DoubleDouble;
use crate::double_double::transforms::nearest;

/// arctan t for |t| ≤ 1/64 and a little: t − t³/3 + … − t¹⁹/19, the terms from t⁹ on in `f64`.
#[inline(always)]
fn small_atan(t: DoubleDouble) -> DoubleDouble {
    let square = -t.times(t);
    let x = square.hi;
    let mut tail = INVERSE_ODD[9].hi;
    for k in (4..9).rev() {
        tail = tail * x + INVERSE_ODD[k].hi;
    }
    let mut sum = INVERSE_ODD[3].plus_double(tail * x);
    for k in (1..3).rev() {
        sum = INVERSE_ODD[k].plus(sum.times(square));
    }
    t.plus(t.times(sum.times(square)))
}

/// arctan(y/x) for 0 ≤ y ≤ x, both finite, x > 0 and neither near the ends of the exponent range.
#[inline(always)]
fn octant(y: DoubleDouble, x: DoubleDouble) -> DoubleDouble {
    let j = nearest(32.0 * (y.hi / x.hi));
    if j == 0.0 {
        return small_atan(y.over(x));
    }
    let c = j / 32.0;
    let t = y.plus(-x.times_double(c)).over(x.plus(y.times_double(c)));
    ATAN[j as usize].plus(small_atan(t))
}

/// arctan(y/x) for 0 < y ≤ x, both finite.
fn first_octant(y: DoubleDouble, x: DoubleDouble) -> DoubleDouble {
    let (i, k) = (y.exponent(), x.exponent());
    if k - i > 108 {
        return y / x; // the next term of the series is below 2⁻²¹⁶
    }
    if k.abs() < 300 {
        octant(y, x)
    } else {
        octant(y.scale(-k), x.scale(-k))
    }
}

impl DoubleDouble {
    /// Angle of the point (x, `self`), in [−π, π].
    pub fn atan2(self, x: Self) -> Self {
        let y = self;
        if x.is_nan() || y.is_nan() {
            return Self::NAN;
        }
        let (u, v) = (y.abs(), x.abs());
        let angle = if u.is_infinite() && v.is_infinite() {
            Self::FRAC_PI_4
        } else if u.hi == 0.0 || v.is_infinite() {
            Self::ZERO
        } else if v.hi == 0.0 || u.is_infinite() {
            Self::FRAC_PI_2
        } else if u <= v {
            first_octant(u, v)
        } else {
            Self::FRAC_PI_2.plus(-first_octant(v, u))
        };
        let angle = if x.is_sign_negative() {
            Self::PI.plus(-angle)
        } else {
            angle
        };
        angle.copysign(y)
    }

    /// Inverse tangent, in [−π/2, π/2].
    pub fn atan(self) -> Self {
        self.atan2(Self::ONE)
    }

    /// Inverse sine, in [−π/2, π/2]; NaN outside [−1, 1].
    pub fn asin(self) -> Self {
        self.atan2(self.complement())
    }

    /// Inverse cosine, in [0, π]; NaN outside [−1, 1].
    pub fn acos(self) -> Self {
        self.complement().atan2(self)
    }

    /// √((1 − x)(1 + x)).
    fn complement(self) -> Self {
        ((Self::ONE - self) * (Self::ONE + self)).sqrt()
    }
}
