//! When two figures, or two tables, are alike.

use crate::sources::Limit;

/// A number as it is written.
#[derive(Debug, PartialEq)]
pub(crate) struct Written {
    pub(crate) value: f64,
    /// What its last digit is worth, 0 in powers of ten.
    pub(crate) unit: f64,
}

/// The text of a cell with a `#` for each of its numbers, and these.
pub(crate) fn numbers(cell: &str) -> (String, Vec<Written>) {
    let cell = cell.replace("**", "").replace('−', "-");
    let (mut text, mut found) = (String::new(), Vec::new());
    let mut rest = cell.as_str();
    while let Some(next) = rest.chars().next() {
        let begins = next.is_ascii_digit()
            || next == '-' && rest[1..].starts_with(|c: char| c.is_ascii_digit());
        let follows_a_word = text.ends_with(char::is_alphabetic);
        if !begins || follows_a_word {
            text.push(next);
            rest = &rest[next.len_utf8()..];
            continue;
        }
        let digits = |text: &str| text.chars().take_while(char::is_ascii_digit).count();
        let mut length = usize::from(next == '-');
        length += digits(&rest[length..]);
        let mut unit = 1.0;
        if rest[length..].starts_with('.') {
            let decimals = digits(&rest[length + 1..]);
            length += if decimals > 0 { decimals + 1 } else { 0 };
            unit = 0.1_f64.powi(decimals as i32);
        }
        if let Some(power) = rest[length..].strip_prefix('e') {
            let sign = usize::from(power.starts_with(['+', '-']));
            let powers = digits(&power[sign..]);
            if powers > 0 {
                length += 1 + sign + powers;
                unit = 0.0;
            }
        }
        let value = rest[..length].parse().unwrap();
        found.push(Written { value, unit });
        text.push('#');
        rest = &rest[length..];
    }
    (text, found)
}

/// Whether the ratio of two numbers is within a factor.
pub(crate) fn is_within(claimed: f64, measured: f64, factor: f64) -> bool {
    let ratio = measured / claimed;
    claimed == measured || (ratio <= factor && ratio >= 1.0 / factor)
}

/// Whether cells have the same text, and numbers within a factor or three units of their last digit.
fn is_alike(claimed: &str, measured: &str, factor: f64) -> bool {
    let ((old_text, old), (new_text, new)) = (numbers(claimed), numbers(measured));
    old_text == new_text
        && old.iter().zip(&new).all(|(old, new)| {
            (old.value - new.value).abs() <= 3.01 * old.unit
                || is_within(old.value, new.value, factor)
        })
}

/// Where two tables differ.
pub(crate) fn differences(claimed: &str, measured: &str, limit: Limit) -> Vec<String> {
    let (old, new) = (cells(claimed), cells(measured));
    let Limit::Factor(factor) = limit else {
        return not_among(&old, &new);
    };
    let mut all = Vec::new();
    if old.iter().map(Vec::len).ne(new.iter().map(Vec::len)) {
        let (old, new) = (old.len(), new.len());
        all.push(format!("{old} rows claimed, {new} measured"));
    }
    for (number, (old, new)) in old.iter().zip(&new).enumerate() {
        for (column, (old, new)) in old.iter().zip(new).enumerate() {
            let is_alike = match number == 0 || column == 1 {
                _ if old.starts_with("---") => true,
                true => old == new,
                false => is_alike(old, new, factor),
            };
            if !is_alike {
                all.push(format!("{old} claimed, {new} measured"));
            }
        }
    }
    all
}

fn cells(table: &str) -> Vec<Vec<String>> {
    let cells = |row: &str| row.split('|').map(|cell| cell.trim().to_owned()).collect();
    table.trim_end().lines().map(cells).collect()
}

/// Titles that are others, and rows whose first cell and number of cells no row of the other table has.
fn not_among(claimed: &[Vec<String>], measured: &[Vec<String>]) -> Vec<String> {
    let mut all = Vec::new();
    if claimed.first() != measured.first() {
        all.push(format!(
            "{:?} claimed, {:?} measured",
            claimed.first(),
            measured.first()
        ));
    }
    for row in claimed.iter().skip(2) {
        let is_like = |other: &&Vec<String>| other.len() == row.len() && other.get(1) == row.get(1);
        if !measured.iter().any(|other| is_like(&other)) {
            all.push(format!("{row:?} claimed, no such row measured"));
        }
    }
    all
}

/// A number in the form of another: with as many decimals, in powers of ten if that is.
pub(crate) fn like(claimed: &str, now: f64) -> String {
    let (mantissa, is_power) = match claimed.split_once('e') {
        Some((mantissa, _)) => (mantissa, true),
        None => (claimed, false),
    };
    let decimals = mantissa.split_once('.').map_or(0, |(_, x)| x.len());
    if is_power {
        format!("{now:.decimals$e}")
    } else {
        format!("{now:.decimals$}")
    }
}
