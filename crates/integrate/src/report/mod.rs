//! The certificate of a run and its measurements.

pub(crate) mod certificate;
pub(crate) mod conserved;
pub(crate) mod energy_round_off;
pub(crate) mod entries;
pub(crate) mod measured;
pub(crate) mod shown;
pub(crate) mod stopwatch;
pub(crate) mod verdict;
