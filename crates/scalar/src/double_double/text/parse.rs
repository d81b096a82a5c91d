//! Decimal to binary, correctly rounded: hi = RN(x), lo = RN(x − hi) for the exact decimal x.

use crate::double_double::integers::to_words;
use num_bigint::BigUint;
use num_traits::Euclid;

/// Digits that are read; 1383 are enough to write any double-double exactly, a set digit beyond only breaks
/// ties.
const DIGITS_KEPT: usize = 1500;
/// Bits behind the binary point: past the half of the smallest subnormal number, 2⁻¹⁰⁷⁵, with room to spare.
const FRACTION_BITS: i32 = 1140;

/// ± 0.d₁d₂… · 10^exponent.
pub(crate) struct Decimal {
    pub(super) negative: bool,
    pub(super) digits: Vec<u8>,
    pub(super) exponent: i64,
}

impl Decimal {
    /// Reads `12.5e-3` and the like; `None` when the text is anything else.
    pub(crate) fn read(text: &str) -> Option<Self> {
        let (negative, text) = sign(text);
        let (mantissa, exponent) = match text.find(['e', 'E']) {
            Some(at) => (&text[..at], read_exponent(&text[at + 1..])?),
            None => (text, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let all = || whole.bytes().chain(fraction.bytes());
        if all().next().is_none() || !all().all(|c| c.is_ascii_digit()) {
            return None;
        }
        let leading = all().take_while(|&c| c == b'0').count();
        let mut digits: Vec<u8> = all().skip(leading).map(|c| c - b'0').collect();
        let exponent = exponent + whole.len() as i64 - leading as i64;
        if digits.len() > DIGITS_KEPT {
            let rest = digits.split_off(DIGITS_KEPT);
            digits.push(u8::from(rest.iter().any(|&d| d != 0)));
        }
        Some(Decimal {
            negative,
            digits,
            exponent,
        })
    }

    /// The sum of N doubles, each of them nearest to what is left by those before it.
    pub(crate) fn to_words<const N: usize>(&self) -> [f64; N] {
        let mut magnitude = [0.0; N];
        let is_zero = self.digits.iter().all(|&d| d == 0) || self.exponent < -400;
        if !is_zero && self.exponent > 400 {
            magnitude[0] = f64::INFINITY;
        } else if !is_zero {
            magnitude = self.magnitude();
        }
        magnitude.map(|word| if self.negative { -word } else { word })
    }

    fn magnitude<const N: usize>(&self) -> [f64; N] {
        let digits = BigUint::from_radix_be(&self.digits, 10).unwrap_or_default();
        // |exponent| ≤ 400 and at most 1501 digits.
        let power = self.exponent as i32 - self.digits.len() as i32;
        let ten = BigUint::from(10_u32).pow(power.unsigned_abs());
        let (n, rest) = match power {
            0.. => ((digits * ten) << FRACTION_BITS, BigUint::ZERO),
            _ => (digits << FRACTION_BITS).div_rem_euclid(&ten),
        };
        // A set bit below stands for the remainder.
        let n: BigUint = (n << 1) + u32::from(rest > BigUint::ZERO);
        to_words(n.into(), -FRACTION_BITS - 1)
    }
}

fn sign(text: &str) -> (bool, &str) {
    match text.as_bytes().first() {
        Some(b'-') => (true, &text[1..]),
        Some(b'+') => (false, &text[1..]),
        _ => (false, text),
    }
}

/// A decimal exponent, saturating far outside the range of any number.
fn read_exponent(text: &str) -> Option<i64> {
    let (negative, digits) = sign(text);
    if digits.is_empty() || !digits.bytes().all(|c| c.is_ascii_digit()) {
        return None;
    }
    let size = digits
        .bytes()
        .fold(0i64, |n, c| (10 * n + i64::from(c - b'0')).min(1 << 50));
    Some(if negative { -size } else { size })
}
