//! eˣ and its relatives, and powers.
//!
//! x = (32k + j)·(ln 2)/32 + r, |r| ≤ (ln 2)/64, eˣ = 2ᵏ · 2^(j/32) · (1 + p), p = eʳ − 1 by its Taylor
//! series [Tang 1989, with a table of 32]. (ln 2)/32 has three parts of which two have trailing zeros, so
//! that n times them is exact [Cody–Waite].

use super::tables::{EXP2, INVERSE_FACTORIAL};
use crate::double_double::number::{DoubleDouble, dd};
use crate::double_double::transforms::{nearest, two_sum};
use crate::traits::half_power::by_squares;

const INVERSE_STEP: f64 = 46.16624130844683; // 32/ln 2
const STEP: [f64; 3] = [
    0.021660849392446835,
    5.1456092446457696e-14,
    9.568252300058288e-26,
];

/// 2^(n/32) (1 + p).
struct Reduced {
    n: i32,
    p: DoubleDouble,
}

impl Reduced {
    /// For finite |x| < 1100.
    #[inline(always)]
    fn new(x: DoubleDouble) -> Self {
        let n = nearest(x.hi * INVERSE_STEP);
        let (s, e) = two_sum(x.hi - n * STEP[0], -n * STEP[1]);
        let r = dd(s, e).plus_double(x.lo).plus_double(-n * STEP[2]);
        Reduced {
            n: n as i32,
            p: small_exp_m1(r),
        }
    }

    #[inline(always)]
    fn power(&self) -> (i32, (f64, f64, f64)) {
        (self.n >> 5, EXP2[(self.n & 31) as usize])
    }

    /// (m, k) with eˣ = m · 2ᵏ, 1 ≤ m < 2 or nearly so.
    #[inline(always)]
    fn value(&self) -> (DoubleDouble, i32) {
        let (k, (t0, t1, _)) = self.power();
        let t = dd(t0, t1);
        (t.plus(t.times(self.p)), k)
    }
}

/// eʳ − 1 for |r| ≤ 0.011: r + r²/2! + … + r¹³/13!. The terms from r⁸ on weigh less than 2⁻⁶⁰ and are summed
/// in `f64`.
#[inline(always)]
fn small_exp_m1(r: DoubleDouble) -> DoubleDouble {
    let x = r.hi;
    let mut tail = INVERSE_FACTORIAL[13].hi;
    for k in (8..13).rev() {
        tail = tail * x + INVERSE_FACTORIAL[k].hi;
    }
    let mut sum = INVERSE_FACTORIAL[7].plus_double(tail * x);
    for k in (2..7).rev() {
        sum = INVERSE_FACTORIAL[k].plus(sum.times(r));
    }
    r.plus(sum.times(r).times(r))
}

impl DoubleDouble {
    /// eˣ.
    #[inline]
    pub fn exp(self) -> Self {
        self.exp_scaled(0)
    }

    /// 2^shift · eˣ without overflow on the way.
    fn exp_scaled(self, shift: i32) -> Self {
        if self.hi.is_nan() || self.hi > 1000.0 {
            return (self.hi + f64::INFINITY).into();
        }
        if self.hi < -1000.0 {
            return Self::ZERO;
        }
        let (m, k) = Reduced::new(self).value();
        let k = k + shift;
        if (-900..1000).contains(&k) {
            let factor = crate::double_double::transforms::power_of_two(k);
            return dd(m.hi * factor, m.lo * factor);
        }
        m.scale(k)
    }

    /// 2ˣ.
    pub fn exp2(self) -> Self {
        if self.hi.is_nan() || self.hi.abs() > 1200.0 {
            return if self.hi < 0.0 {
                Self::ZERO
            } else {
                (self.hi + f64::INFINITY).into()
            };
        }
        let n = nearest(32.0 * self.hi);
        let r = self.plus_double(-n / 32.0).times(Self::LN_2);
        let (m, k) = Reduced {
            n: n as i32,
            p: small_exp_m1(r),
        }
        .value();
        m.scale(k)
    }

    /// eˣ − 1, accurate near 0.
    pub fn exp_m1(self) -> Self {
        if self.hi.abs() < 1e-33 {
            return self;
        }
        if self.hi.is_nan() || self.hi > 80.0 {
            return self.exp();
        }
        if self.hi < -80.0 {
            return -Self::ONE;
        }
        let reduced = Reduced::new(self);
        let (k, (t0, t1, t2)) = reduced.power();
        if reduced.n == 0 {
            return reduced.p;
        }
        let factor = crate::double_double::transforms::power_of_two(k);
        let (s, e) = two_sum(t0 * factor, -1.0);
        let head = dd(s, e).plus_double(t1 * factor).plus_double(t2 * factor);
        head.plus(dd(t0 * factor, t1 * factor).times(reduced.p))
    }

    /// Hyperbolic sine: (p + p/(p + 1))/2 with p = e^|x| − 1.
    pub fn sinh(self) -> Self {
        let x = self.abs();
        let y = if x.hi < 1e-33 {
            x
        } else if x.hi < 40.0 {
            let p = x.exp_m1();
            p.plus(p.over(p.plus_double(1.0))).half()
        } else {
            x.exp_scaled(-1)
        };
        y.copysign(self)
    }

    /// Hyperbolic cosine: (e + 1/e)/2 with e = e^|x|.
    pub fn cosh(self) -> Self {
        let x = self.abs();
        if x.hi < 40.0 {
            let e = x.exp();
            return e.plus(Self::ONE.over(e)).half();
        }
        x.exp_scaled(-1)
    }

    /// Hyperbolic tangent: p/(p + 2) with p = e^(2|x|) − 1; exactly ±1 from 38 on.
    pub fn tanh(self) -> Self {
        let x = self.abs();
        let y = if x.hi < 1e-33 {
            x
        } else if x.hi < 38.0 {
            let p = x.plus(x).exp_m1();
            p.over(p.plus_double(2.0))
        } else if x.is_nan() {
            return self;
        } else {
            Self::ONE
        };
        y.copysign(self)
    }

    /// (sinh x, cosh x).
    pub fn sinh_cosh(self) -> (Self, Self) {
        (self.sinh(), self.cosh())
    }

    /// xⁿ by repeated squaring; the error grows like n times that of a product, 1.25·2⁻¹⁰⁴ at most.
    #[inline]
    pub fn powi(self, n: i32) -> Self {
        let power_of = |x: Self| by_squares(x, n.unsigned_abs()).unwrap_or(Self::ONE);
        let power = power_of(self);
        if n >= 0 {
            return power;
        }
        let size = power.hi.abs();
        if size > crate::double_double::transforms::SAFE_MIN && size < f64::INFINITY {
            return power.recip();
        }
        // xⁿ over- or underflowed although 1/xⁿ need not: invert first.
        power_of(self.recip())
    }

    /// xʸ. Integers up to 64 by multiplication, otherwise exp(y ln x), whose relative error is
    /// at most (8 + 4 |y ln x|)·2⁻¹⁰⁴. Special cases are those of `f64::powf`.
    pub fn powf(self, y: Self) -> Self {
        let whole = y.trunc() == y;
        if whole && y.hi.abs() <= 64.0 {
            return self.powi(y.hi as i32);
        }
        if self == Self::ONE {
            return Self::ONE;
        }
        if self.is_nan() || y.is_nan() {
            return Self::NAN;
        }
        let odd = whole && y.is_finite() && y.half().trunc() != y.half();
        if y.is_infinite() {
            let size = self.abs();
            return if size == Self::ONE {
                Self::ONE
            } else if (size > Self::ONE) == (y.hi > 0.0) {
                Self::INFINITY
            } else {
                Self::ZERO
            };
        }
        if self.hi == 0.0 || self.is_infinite() {
            let large = self.is_infinite() == (y.hi > 0.0);
            let size = if large { Self::INFINITY } else { Self::ZERO };
            return if odd { size.copysign(self) } else { size };
        }
        if self.hi < 0.0 && !whole {
            return Self::NAN;
        }
        let size = (self.abs().ln() * y).exp();
        if odd { size.copysign(self) } else { size }
    }
}
