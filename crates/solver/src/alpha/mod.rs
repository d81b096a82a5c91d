//! The parameters α: their direction, and how far they may change y1.

pub(crate) mod admissible;
pub(crate) mod direction;
pub(crate) mod least_displacement;
pub(crate) mod local_error;
