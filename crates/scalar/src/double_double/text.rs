//! Sums of doubles as decimal text, and a [`DoubleDouble`] among them.

use super::number::{DoubleDouble, dd};
use parse::Decimal;

pub(crate) mod parse;
pub(crate) mod print;

impl DoubleDouble {
    pub(crate) fn nearest(decimal: &Decimal) -> Self {
        let [hi, lo] = decimal.to_words();
        dd(hi, lo)
    }

    /// Digits of which a decimal always has as many.
    pub(crate) fn digits() -> i64 {
        31
    }
}
