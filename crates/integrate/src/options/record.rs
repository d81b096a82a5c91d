//! [`Record`]: which steps a run stores.

/// Which steps of the grid a [`Run`](crate::Run) stores. The first and the last state are always stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Record {
    /// Every step.
    #[default]
    All,
    /// Every k-th step, k ≥ 1.
    Every(u64),
    /// The first and the last state only.
    Ends,
}

impl Record {
    /// Whether the step with this `index` is stored.
    pub(crate) fn keeps(self, index: u64) -> bool {
        match self {
            Record::All => true,
            Record::Every(k) => index.is_multiple_of(k),
            Record::Ends => false,
        }
    }
}
