//! The trace of H, in which every operation occurs once, and the graph of the operations on which H depends.

pub(crate) mod bytes;
pub(crate) mod graph;
pub(crate) mod keyed;
pub(crate) mod op;
pub(crate) mod read;
pub(crate) mod recorder;
pub(crate) mod trace;
