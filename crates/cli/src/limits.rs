//! The limits by which `equip check` judges a row, and which its help names.

/// Largest energy error in round-off levels.
pub(crate) const LEVELS: f64 = 8.0;
/// Largest energy error beside uncorrected steps over that of Gauss.
pub(crate) const UNCORRECTED: f64 = 2.0;
/// Largest trajectory error over that of Gauss.
pub(crate) const TRAJECTORY: f64 = 3.0;
