//! What a run has kept, measured.

pub(crate) mod certificate;
pub(crate) mod chaos_indicators;
pub(crate) mod defect;
pub(crate) mod variable_steps;
