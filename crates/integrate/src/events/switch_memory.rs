//! [`SwitchMemory`]: what a checkpoint keeps of the discontinuities of H.

/// What is known of the switches of H where the next step begins; empty of an H that has none.
#[derive(Debug, Clone, Default, PartialEq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub(crate) struct SwitchMemory {
    /// Of every one of them whether the step begins on it, and with which sign it continues.
    pub(crate) sides: Vec<Option<i8>>,
    /// Whether the step before met knots of a table.
    pub(crate) is_among_knots: bool,
}
