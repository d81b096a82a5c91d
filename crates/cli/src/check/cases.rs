//! The catalogue: rows as data, by theme.

mod chaotic;
mod degenerate;
mod large;
mod long;
mod singular;
mod stiff;
mod units;

use super::case::Case;

/// All rows, in the order of the table.
pub(crate) fn catalogue() -> Vec<Case> {
    let themes = [
        ("stiff", stiff::cases()),
        ("chaotic", chaotic::cases()),
        ("singular", singular::cases()),
        ("units", units::cases()),
        ("degenerate", degenerate::cases()),
        ("large", large::cases()),
        ("long", long::cases()),
    ];
    let of = |(theme, cases): (_, Vec<Case>)| {
        let cases = cases.into_iter();
        cases.map(move |case| Case { theme, ..case })
    };
    themes.into_iter().flat_map(of).collect()
}
