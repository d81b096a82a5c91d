//! A graph laid out as a tape, and its replay in any number.

pub(crate) mod batch;
pub(crate) mod forward;
pub(crate) mod layout;
pub(crate) mod point;
pub(crate) mod tape;
pub(crate) mod values;
