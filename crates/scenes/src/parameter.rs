//! Parameters of a scene: what they mean, what they may be, and how their text is read.
//!
//! Values are decimal text (`0.1`, `1e-3`) or quotients (`1/12`) and are kept as exact constants: a run in
//! double-double reads `0.1` as 1/10, not as the double nearest to it.

use crate::SceneError;
use equip_scalar::{Constant, DoubleDouble, Float};
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

/// The number written in `text`: exact whenever numerator and denominator fit in 53 bits and 63 bits,
/// otherwise to double-double precision.
fn constant(text: &str) -> Option<Constant> {
    if let Some((n, d)) = text.split_once('/') {
        let (n, d) = (n.trim().parse::<i64>().ok()?, d.trim().parse::<i64>().ok()?);
        return (d != 0 && d != i64::MIN && n != i64::MIN).then(|| reduced(n, d));
    }
    let nearest = f64::decimal(text).ok().filter(|x| x.is_finite())?;
    match short_decimal(text) {
        Some((n, d)) => Some(reduced(n, d)),
        None if nearest == 0.0 => Some(Constant::Double(0.0)),
        None => DoubleDouble::decimal(text).ok().map(Constant::from),
    }
}

/// Largest k for which 10^k is an exact double quotient partner of 53-bit integers and fits in an `i64`.
const MOST_DECIMALS: i64 = 18;

/// `text` as n/10^k or n·10^k when that is short enough to be exact.
fn short_decimal(text: &str) -> Option<(i64, i64)> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i64>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}").parse::<i64>().ok()?;
    let shift = exponent.checked_sub(i64::try_from(fraction.len()).ok()?)?;
    let power = |k: i64| {
        (k <= MOST_DECIMALS).then(|| u32::try_from(k).ok().and_then(|k| 10_i64.checked_pow(k)))?
    };
    let (n, d) = if shift < 0 {
        (digits, power(-shift)?)
    } else {
        (digits.checked_mul(power(shift)?)?, 1)
    };
    (n.unsigned_abs() < 1 << 53).then_some((n, d))
}

/// n/d in lowest terms, as a double where it is one.
fn reduced(n: i64, d: i64) -> Constant {
    let (mut a, mut b) = (n.unsigned_abs(), d.unsigned_abs());
    while b != 0 {
        (a, b) = (b, a % b);
    }
    let divisor = i64::try_from(a).unwrap_or(1) * d.signum();
    let (n, d) = (n / divisor, d / divisor);
    let exact_quotient = d & (d - 1) == 0 && n.unsigned_abs() < 1 << 53;
    if exact_quotient {
        Constant::Double(n as f64 / d as f64)
    } else {
        Constant::Ratio(n, d)
    }
}

#[cfg(test)]
mod tests {
    use super::{Range, constant};
    use equip_scalar::{Constant, DoubleDouble, Float};

    #[test]
    fn short_texts_are_exact_quotients() {
        assert_eq!(constant("0.1"), Some(Constant::Ratio(1, 10)));
        assert_eq!(constant("1e-1"), Some(Constant::Ratio(1, 10)));
        assert_eq!(constant("-2.5e-1"), Some(Constant::Double(-0.25)));
        assert_eq!(constant("1/12"), Some(Constant::Ratio(1, 12)));
        assert_eq!(constant("2/-24"), Some(Constant::Ratio(-1, 12)));
        assert_eq!(constant("50"), Some(Constant::Double(50.0)));
        assert_eq!(constant("0"), Some(Constant::Double(0.0)));
        assert_eq!(constant(".6"), Some(Constant::Ratio(3, 5)));
    }

    #[test]
    fn long_texts_keep_double_double_digits() {
        let text = "2.00158510637908252240537862224";
        let read = constant(text).unwrap().to::<DoubleDouble>();
        assert_eq!(read, DoubleDouble::decimal(text).unwrap());
    }

    #[test]
    fn the_double_nearest_to_the_text_comes_back() {
        for text in [
            "0.1",
            "0.6",
            "1e-3",
            "0.012277471",
            "19.6",
            "2.7746",
            "1e22",
            "1e-30",
        ] {
            assert_eq!(
                constant(text).unwrap().to::<f64>(),
                text.parse::<f64>().unwrap(),
                "{text}"
            );
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in ["", "x", "nan", "inf", "1/0", "1/", "1/2.5", "0x10", "1e999"] {
            assert_eq!(constant(text), None, "{text}");
        }
    }

    #[test]
    fn ranges_know_their_ends() {
        let range = Range::below(0.0, 1.0);
        assert!(range.contains(0.0) && !range.contains(1.0) && !range.contains(f64::NAN));
        assert_eq!(range.to_string(), "[0, 1)");
        assert_eq!(Range::above(0.0, 1.5).to_string(), "(0, 1.5]");
    }
}
