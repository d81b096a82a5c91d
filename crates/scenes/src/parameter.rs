//! The parameters of a scene: their meaning and range.

use equip_scalar::Constant;
use std::f64::consts::PI;
use std::fmt;

/// An interval on the real line, with its ends in or out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Whether the lower end itself is allowed.
    pub low_included: bool,
    /// Upper end.
    pub high: f64,
    /// Whether the upper end itself is allowed.
    pub high_included: bool,
}

impl Range {
    const fn new((low, low_included): (f64, bool), (high, high_included): (f64, bool)) -> Self {
        Range {
            low,
            low_included,
            high,
            high_included,
        }
    }

    /// [low, high].
    pub(crate) const fn closed(low: f64, high: f64) -> Self {
        Range::new((low, true), (high, true))
    }

    /// [low, high).
    pub(crate) const fn below(low: f64, high: f64) -> Self {
        Range::new((low, true), (high, false))
    }

    /// (low, high].
    pub(crate) const fn above(low: f64, high: f64) -> Self {
        Range::new((low, false), (high, true))
    }

    /// (low, high).
    pub(crate) const fn open(low: f64, high: f64) -> Self {
        Range::new((low, false), (high, false))
    }

    /// Angles on either side of zero, in radians.
    pub(crate) const fn angle() -> Self {
        Range::closed(-PI, PI)
    }

    /// Whether x lies in the interval; NaN does not.
    pub fn contains(&self, x: f64) -> bool {
        let above = x > self.low || (self.low_included && x == self.low);
        let below = x < self.high || (self.high_included && x == self.high);
        above && below
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let open = if self.low_included { '[' } else { '(' };
        let close = if self.high_included { ']' } else { ')' };
        write!(f, "{open}{}, {}{close}", self.low, self.high)
    }
}

/// One parameter of a scene. All are dimensionless unless their meaning names a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name, as in `--e 0.9`.
    pub name: &'static str,
    /// The meaning, as text.
    pub meaning: &'static str,
    /// The default value, as text.
    pub default: &'static str,
    /// The allowed values.
    pub range: Range,
    /// Whether only whole numbers are allowed.
    pub integer: bool,
}

impl Parameter {
    pub(crate) const fn real(
        name: &'static str,
        meaning: &'static str,
        default: &'static str,
        range: Range,
    ) -> Self {
        Parameter {
            name,
            meaning,
            default,
            range,
            integer: false,
        }
    }
}

/// A value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Value {
    /// As exact as it was written.
    pub(crate) exact: Constant,
    /// The nearest double.
    pub(crate) nearest: f64,
    /// As it was written.
    pub(crate) text: String,
}

/// What a value becomes in a Hamiltonian.
pub(crate) trait Field {
    /// Whether only whole numbers are allowed.
    const IS_WHOLE: bool;

    fn of(value: &Value) -> Self;
}

impl Field for Constant {
    const IS_WHOLE: bool = false;

    fn of(value: &Value) -> Self {
        value.exact
    }
}

impl Field for usize {
    const IS_WHOLE: bool = true;

    fn of(value: &Value) -> Self {
        value.nearest as usize
    }
}

impl Field for u64 {
    const IS_WHOLE: bool = true;

    fn of(value: &Value) -> Self {
        value.nearest as u64
    }
}

#[cfg(test)]
mod tests {
    use super::Range;

    #[test]
    fn ranges_know_their_ends() {
        let range = Range::below(0.0, 1.0);
        assert!(range.contains(0.0) && !range.contains(1.0) && !range.contains(f64::NAN));
        assert_eq!(range.to_string(), "[0, 1)");
        assert_eq!(Range::above(0.0, 1.5).to_string(), "(0, 1.5]");
    }
}
