//! Operations of H as they are met, each once, and the graph of those that reach H.

pub(crate) mod bytes;
pub(crate) mod graph;
pub(crate) mod keyed;
pub(crate) mod op;
pub(crate) mod peephole;
pub(crate) mod read;
pub(crate) mod recorder;
pub(crate) mod trace;
