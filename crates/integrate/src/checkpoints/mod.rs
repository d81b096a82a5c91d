//! What a run needs to go on bit for bit.

pub(crate) mod checkpoint;
pub(crate) mod checksum;
pub(crate) mod exact;
pub(crate) mod memories;
