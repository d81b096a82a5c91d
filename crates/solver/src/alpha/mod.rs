//! The parameters α: their search direction, and bounds on the change of y1.

pub(crate) mod admissible;
pub(crate) mod direction;
pub(crate) mod least_displacement;
pub(crate) mod local_error;
