//! Floor, ceiling, truncation, rounding, and conversion from and to integers. All exact.

use super::number::DoubleDouble;

impl DoubleDouble {
    /// The largest integer not above the number.
    pub fn floor(self) -> Self {
        let hi = self.hi.floor();
        if hi == self.hi && self.hi.is_finite() {
            Self::new(hi, self.lo.floor())
        } else {
            hi.into()
        }
    }

    /// An integer, exactly.
    pub fn from_i64(n: i64) -> Self {
        let magnitude = Self::from_u64(n.unsigned_abs());
        if n < 0 { -magnitude } else { magnitude }
    }

    /// An integer, exactly.
    #[inline]
    pub fn from_u64(n: u64) -> Self {
        let upper = (n >> 32) as f64 * 4_294_967_296.0;
        Self::ordered(upper, (n & 0xffff_ffff) as f64)
    }

    /// An integer, to 106 bits.
    pub fn from_u128(n: u128) -> Self {
        Self::from_u64((n >> 64) as u64).scale(64) + Self::from_u64(n as u64)
    }

    /// An integer, to 106 bits.
    pub fn from_i128(n: i128) -> Self {
        let magnitude = Self::from_u128(n.unsigned_abs());
        if n < 0 { -magnitude } else { magnitude }
    }

    /// The integer part, where it fits.
    pub fn to_i128(self) -> Option<i128> {
        let whole = self.trunc();
        let limit = super::transforms::power_of_two(127);
        if whole.hi == limit && whole.lo < 0.0 {
            return i128::MAX.checked_add(whole.lo as i128 + 1);
        }
        let fits = -limit <= whole.hi && whole.hi < limit;
        if fits {
            (whole.hi as i128).checked_add(whole.lo as i128)
        } else {
            None
        }
    }

    /// The integer part, where it fits.
    pub fn to_u128(self) -> Option<u128> {
        let whole = self.trunc();
        let limit = super::transforms::power_of_two(128);
        if !(whole.hi >= 0.0 && whole.hi <= limit) {
            return None;
        }
        if whole.hi == limit {
            return if whole.lo < 0.0 {
                u128::MAX.checked_sub((-whole.lo) as u128 - 1)
            } else {
                None
            };
        }
        (whole.hi as u128).checked_add_signed(whole.lo as i128)
    }
}
