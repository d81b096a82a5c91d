//! Runs from many starts: where they start, and all of them in parallel.

pub(crate) mod drawn;
pub(crate) mod starts;
