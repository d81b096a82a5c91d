//! Checkpoints: what a run needs to continue bit for bit.

pub(crate) mod checkpoint;
pub(crate) mod checksum;
pub(crate) mod exact;
pub(crate) mod memory;
