//! The methods that EQUIP is compared with, one step at a time.

pub(crate) mod composition;
pub(crate) mod dop853;
mod dop853_tableau;
pub(crate) mod flow;
