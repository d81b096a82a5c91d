//! The small commands.

pub(crate) mod ensemble;
pub(crate) mod growth;
pub(crate) mod merge;
pub(crate) mod scenes;
pub(crate) mod section;
