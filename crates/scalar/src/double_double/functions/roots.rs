//! Square root, cube root, hypotenuse.

use crate::double_double::number::{DoubleDouble, dd};
use crate::double_double::transforms::{SAFE_MAX, SAFE_MIN, exponent};
use crate::double_double::words;

impl DoubleDouble {
    /// √x; NaN below zero.
    #[inline]
    pub fn sqrt(self) -> Self {
        if SAFE_MIN <= self.hi && self.hi < SAFE_MAX {
            return self.root();
        }
        if self.hi > 0.0 && self.hi.is_finite() {
            let k = if self.hi < 1.0 { 600 } else { -600 };
            return self.scale(k).root().scale(-k / 2);
        }
        self.hi.sqrt().into()
    }

    #[inline(always)]
    fn root(self) -> Self {
        Self::of(words::root(self.words(), self.hi.sqrt()))
    }

    /// ∛x.
    ///
    /// Newton's iteration in `f64` for y ≈ ∛m, 1 ≤ m < 8, then y (1 + e/3 − e²/9) with e = (m − y³)/y³.
    pub fn cbrt(self) -> Self {
        if self.hi == 0.0 || !self.hi.is_finite() {
            return self;
        }
        let thirds = exponent(self.hi).div_euclid(3);
        let m = self.abs().scale(-3 * thirds);
        let mut y = 0.25 * m.hi.min(4.0) + 0.85;
        for _ in 0..5 {
            y -= (y * y * y - m.hi) / (3.0 * y * y);
        }
        let cube = dd(y, 0.0).times_double(y).times_double(y);
        let e = m.plus(-cube).over(cube);
        let correction = e.over(dd(3.0, 0.0)).plus_double(-e.hi * e.hi / 9.0);
        let root = correction.times_double(y).plus_double(y);
        root.scale(thirds).copysign(self)
    }

    /// √(x² + y²), scaled so that nothing overflows on the way.
    pub fn hypot(self, other: Self) -> Self {
        if self.is_infinite() || other.is_infinite() {
            return Self::INFINITY;
        }
        let (x, y) = (self.abs(), other.abs());
        let (large, small) = if x.hi >= y.hi { (x, y) } else { (y, x) };
        if small.hi == 0.0 || x.is_nan() || y.is_nan() {
            return if x.is_nan() {
                x
            } else if y.is_nan() {
                y
            } else {
                large
            };
        }
        let k = large.exponent();
        if k.abs() < 400 && small.exponent() > -400 {
            return (large.times(large)).plus(small.times(small)).sqrt();
        }
        let (a, b) = (large.scale(-k), small.scale(-k));
        a.times(a).plus(b.times(b)).sqrt().scale(k)
    }
}
