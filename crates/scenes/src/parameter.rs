//! Parameters of a scene: what they mean, and what they may be.

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
    /// [low, high].
    pub(crate) const fn closed(low: f64, high: f64) -> Self {
        Range {
            low,
            low_included: true,
            high,
            high_included: true,
        }
    }

    /// [low, high).
    pub(crate) const fn below(low: f64, high: f64) -> Self {
        Range {
            low,
            low_included: true,
            high,
            high_included: false,
        }
    }

    /// (low, high].
    pub(crate) const fn above(low: f64, high: f64) -> Self {
        Range {
            low,
            low_included: false,
            high,
            high_included: true,
        }
    }

    /// Angles on either side of zero, in radians.
    pub(crate) const ANGLE: Range = Range::closed(-PI, PI);

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
    /// Meaning, for people.
    pub meaning: &'static str,
    /// Value taken when none is given, as text.
    pub default: &'static str,
    /// Values allowed.
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

    pub(crate) const fn count(
        name: &'static str,
        meaning: &'static str,
        default: &'static str,
        low: u32,
        high: u32,
    ) -> Self {
        let range = Range::closed(low as f64, high as f64);
        Parameter {
            name,
            meaning,
            default,
            range,
            integer: true,
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

impl Value {
    /// The value of an integer parameter, whose range is that of a count.
    pub(crate) fn count(&self) -> usize {
        self.nearest as usize
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
