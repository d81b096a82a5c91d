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
    [
        stiff::cases(),
        chaotic::cases(),
        singular::cases(),
        units::cases(),
        degenerate::cases(),
        large::cases(),
        long::cases(),
    ]
    .into_iter()
    .flatten()
    .collect()
}
