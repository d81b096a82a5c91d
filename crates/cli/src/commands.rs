//! The small commands.

pub(crate) mod growth;
pub(crate) mod scenes;
pub(crate) mod section;
