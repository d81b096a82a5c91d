//! Parameters of a scene: what they mean, what they may be, and how their text is read.
//!
//! Values are decimal text (`0.1`, `1e-3`) or quotients (`1/12`) and are kept as exact constants: a run in
//! double-double reads `0.1` as 1/10, not as the double nearest to it.

use crate::SceneError;
use crate::decimal_text::constant;
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

    fn read(&self, scene: &'static str, text: &str) -> Result<Value, SceneError> {
        let parameter = self.name;
        let text = text.trim();
        let exact = constant(text).ok_or_else(|| SceneError::NotANumber {
            scene,
            parameter,
            text: text.into(),
        })?;
        let nearest = exact.to::<f64>();
        if self.integer && nearest.fract() != 0.0 {
            return Err(SceneError::NotAnInteger {
                scene,
                parameter,
                text: text.into(),
                range: self.range,
            });
        }
        if !self.range.contains(nearest) {
            return Err(SceneError::OutOfRange {
                scene,
                parameter,
                text: text.into(),
                range: self.range,
            });
        }
        Ok(Value {
            exact,
            nearest,
            text: text.into(),
        })
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

/// Reads `given` over the defaults of `parameters`, in the order of `parameters`.
pub(crate) fn read_all(
    scene: &'static str,
    parameters: &'static [Parameter],
    given: &[(&str, &str)],
) -> Result<Vec<Value>, SceneError> {
    if let Some((name, _)) = given
        .iter()
        .find(|(n, _)| parameters.iter().all(|p| p.name != *n))
    {
        return Err(SceneError::UnknownParameter {
            scene,
            name: (*name).into(),
            known: parameters.iter().map(|p| p.name).collect(),
        });
    }
    parameters
        .iter()
        .map(|parameter| {
            let mut texts = given
                .iter()
                .filter(|(n, _)| *n == parameter.name)
                .map(|(_, t)| *t);
            let text = texts.next().unwrap_or(parameter.default);
            if texts.next().is_some() {
                return Err(SceneError::GivenTwice {
                    scene,
                    parameter: parameter.name,
                });
            }
            parameter.read(scene, text)
        })
        .collect()
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
