//! The certificate of a run and its measurements.

pub(crate) mod certificate;
pub(crate) mod chaos_indicators;
pub(crate) mod conserved;
pub(crate) mod energy_jumps;
pub(crate) mod energy_round_off;
pub(crate) mod measured;
pub(crate) mod phase_per_step;
pub(crate) mod shown;
pub(crate) mod stopwatch;
pub(crate) mod variable_steps;
pub(crate) mod verdict;
