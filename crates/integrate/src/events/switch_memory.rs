//! [`SwitchMemory`]: the state of the discontinuities of H in a checkpoint.

/// The state of the switches of H at the start of the next step; empty if H has none.
#[derive(Debug, Clone, Default, PartialEq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub(crate) struct SwitchMemory {
    /// For every switch, whether the step begins on the switch, and with which sign it continues.
    pub(crate) sides: Vec<Option<i8>>,
    /// Whether the last step met knots of a table.
    pub(crate) is_among_knots: bool,
}
