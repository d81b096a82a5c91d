//! Numbers written as text, kept exact.
//!
//! A decimal or a quotient of integers becomes a constant that every float type reads in its own precision: a
//! double if it is one, else n/d in lowest terms, and only if that is too long a double-double.

use equip_scalar::{Constant, DoubleDouble, Float, ratio};

/// The number written in `text`: exact whenever numerator and denominator fit in 53 bits and 63 bits,
/// otherwise to double-double precision.
pub(crate) fn constant(text: &str) -> Option<Constant> {
    if let Some((n, d)) = text.split_once('/') {
        let (n, d) = (n.trim().parse::<i64>().ok()?, d.trim().parse::<i64>().ok()?);
        return (d != 0 && d != i64::MIN && n != i64::MIN).then(|| reduced(n, d));
    }
    let nearest = f64::decimal(text).ok().filter(|x| x.is_finite())?;
    match short_decimal(text) {
        Some((n, d)) => Some(reduced(n, d)),
        None if nearest == 0.0 => Some(Constant::double(0.0)),
        None => DoubleDouble::decimal(text).ok().map(Constant::from),
    }
}

/// `text` as n/10^k or n·10^k when that is short enough to be exact.
fn short_decimal(text: &str) -> Option<(i64, i64)> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i64>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}").parse::<i64>().ok()?;
    let shift = exponent.checked_sub(i64::try_from(fraction.len()).ok()?)?;
    let power = |k: i64| u32::try_from(k).ok().and_then(|k| 10_i64.checked_pow(k));
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
        Constant::double(n as f64 / d as f64)
    } else {
        ratio(n, d)
    }
}

#[cfg(test)]
mod tests {
    use super::constant;
    use equip_scalar::{Constant, DoubleDouble, Float, ratio};

    #[test]
    fn short_texts_are_exact_quotients() {
        assert_eq!(constant("0.1"), Some(ratio(1, 10)));
        assert_eq!(constant("1e-1"), Some(ratio(1, 10)));
        assert_eq!(constant("-2.5e-1"), Some(Constant::double(-0.25)));
        assert_eq!(constant("1/12"), Some(ratio(1, 12)));
        assert_eq!(constant("2/-24"), Some(ratio(-1, 12)));
        assert_eq!(constant("50"), Some(Constant::double(50.0)));
        assert_eq!(constant("0"), Some(Constant::double(0.0)));
        assert_eq!(constant(".6"), Some(ratio(3, 5)));
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
}
