//! Runs from many initial states: random states, and parallel integration.

pub(crate) mod drawn;
pub(crate) mod starts;
