//! Step control: the sizes of steps.

pub(crate) mod controller;
pub(crate) mod escape;
pub(crate) mod estimate;
pub(crate) mod failed;
pub(crate) mod first_step;
pub(crate) mod flow;
pub(crate) mod frequency;
pub(crate) mod policy;
pub(crate) mod rate;
pub(crate) mod stuck;
