//! Files: the table of a run, its checkpoints, and outputs that no other program writes at the time.

pub(crate) mod checkpoint;
pub(crate) mod csv;
pub(crate) mod json;
pub(crate) mod lock;
pub(crate) mod outputs;
