//! [`DoubleDouble`]: about 31 digits.

/// An unevaluated sum of two doubles, `hi` being the sum rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

impl DoubleDouble {
    /// The number as an unevaluated sum, largest part first.
    pub fn expansion(self) -> [f64; 4] {
        [self.hi, self.lo, 0.0, 0.0]
    }
}
