//! Time: its direction, and time as a coordinate.

pub(crate) mod direction;
pub(crate) mod extended;
pub(crate) mod visible;
