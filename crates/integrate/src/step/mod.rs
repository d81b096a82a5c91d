//! One step, and what a failure of it is called.

pub(crate) mod escape;
pub(crate) mod make;
