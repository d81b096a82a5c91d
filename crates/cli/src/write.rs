//! What a run leaves behind: its table, its checkpoints, its certificate as JSON.

pub(crate) mod checkpoint;
pub(crate) mod checksum;
pub(crate) mod csv;
pub(crate) mod json;
pub(crate) mod lock;
pub(crate) mod outputs;
