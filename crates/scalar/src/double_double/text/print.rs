//! Binary to decimal.
//!
//! Every sum of doubles is a finite decimal. Its digits are computed exactly and rounded (half to even) to
//! the requested precision. By default the shortest of a few lengths is used that parses back to the same
//! number (for double-doubles 31 digits or more), without trailing zeros.

use super::parse::Decimal;
use crate::double_double::integers::{integer, unit};
use num_bigint::BigUint;
use std::fmt;

/// Positional notation without a given precision for 10⁻⁶ ≤ |x| < 10³³; outside it is scientific.
const POSITIONAL: std::ops::Range<i64> = -5..34;

/// All decimal digits of a finite sum of doubles, largest first.
fn exact(x: &[f64]) -> Decimal {
    let unit = unit(x);
    // m/2ᵏ = m 5ᵏ/10ᵏ
    let places = (-unit).max(0);
    let m = integer(x, unit.min(0)).into_parts().1;
    let mut digits = (m * BigUint::from(5_u32).pow(places as u32)).to_radix_be(10);
    if digits == [0] {
        digits.clear();
    }
    let exponent = digits.len() as i64 - i64::from(places);
    Decimal {
        negative: x[0].is_sign_negative(),
        digits,
        exponent,
    }
}

impl Decimal {
    /// Rounded to `count` digits, half to even; fewer when the number has fewer. A negative count gives zero.
    fn rounded(&self, count: i64) -> Self {
        let mut decimal = Decimal {
            negative: self.negative,
            digits: self.digits.clone(),
            exponent: self.exponent,
        };
        if count >= self.digits.len() as i64 {
            return decimal;
        }
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        if count == usize::MAX {
            decimal.digits.clear();
            return decimal;
        }
        let rest = decimal.digits.split_off(count);
        let half = rest[0] > 5 || rest[0] == 5 && rest[1..].iter().any(|&d| d != 0);
        let tie = rest[0] == 5 && !half;
        if half || tie && decimal.digits.last().is_some_and(|d| d % 2 == 1) {
            decimal.increment();
        }
        decimal
    }

    fn increment(&mut self) {
        for digit in self.digits.iter_mut().rev() {
            if *digit < 9 {
                *digit += 1;
                return;
            }
            *digit = 0;
        }
        self.digits.insert(0, 1);
        self.exponent += 1;
    }

    /// The shortest tried rounding of at least `least` digits that is the `same` number, without trailing
    /// zeros.
    fn shortest(&self, least: i64, same: impl Fn(&Decimal) -> bool) -> Self {
        let further = [40, 48, 64, 96, 128, 256, 512];
        let further = further.into_iter().filter(|&count| count > least + 5);
        let candidates = (least..=least + 5).chain(further);
        let mut decimal = candidates
            .map(|count| self.rounded(count))
            .take_while(|d| d.digits.len() < self.digits.len())
            .find(same)
            .unwrap_or_else(|| self.rounded(i64::MAX));
        while decimal.digits.last() == Some(&0) {
            decimal.digits.pop();
        }
        decimal
    }

    fn digit(&self, i: i64) -> char {
        let digit = usize::try_from(i).ok().and_then(|i| self.digits.get(i));
        char::from(b'0' + digit.copied().unwrap_or(0))
    }

    fn positional(&self, decimals: usize) -> String {
        let mut text: String = (0..self.exponent.max(0)).map(|i| self.digit(i)).collect();
        if text.is_empty() {
            text.push('0');
        }
        if decimals > 0 {
            text.push('.');
            text.extend((0..decimals as i64).map(|i| self.digit(self.exponent + i)));
        }
        text
    }

    fn scientific(&self, decimals: usize) -> String {
        let mut text = String::from(self.digit(0));
        if decimals > 0 {
            text.push('.');
            text.extend((1..=decimals as i64).map(|i| self.digit(i)));
        }
        let exponent = if self.digits.is_empty() {
            0
        } else {
            self.exponent - 1
        };
        text.push('e');
        text.push_str(&exponent.to_string());
        text
    }
}

/// Prints a sum of doubles as [`fmt::Display`], or with `scientific` as [`fmt::LowerExp`]: with a precision
/// exactly so many decimals, as `f64`; without one, at least `least` digits, so many that they are the `same`
/// number.
pub(crate) fn print(
    x: &[f64],
    least: i64,
    scientific: bool,
    same: impl Fn(&Decimal) -> bool,
    f: &mut fmt::Formatter<'_>,
) -> fmt::Result {
    if !x[0].is_finite() {
        return fmt::Display::fmt(&x[0], f);
    }
    let all = exact(x);
    let text = match f.precision() {
        Some(decimals) if scientific => all
            .rounded((decimals as i64).saturating_add(1))
            .scientific(decimals),
        Some(decimals) => all
            .rounded(all.exponent.saturating_add(decimals as i64))
            .positional(decimals),
        None => {
            let decimal = all.shortest(least, same);
            let length = decimal.digits.len() as i64;
            if scientific || length > 0 && !POSITIONAL.contains(&decimal.exponent) {
                decimal.scientific((length - 1).max(0) as usize)
            } else if length == 0 {
                decimal.positional(0)
            } else {
                decimal.positional((length - decimal.exponent).max(0) as usize)
            }
        }
    };
    f.pad_integral(x[0].is_sign_positive(), "", &text)
}
