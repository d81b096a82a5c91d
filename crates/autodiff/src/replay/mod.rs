//! Graphs in the layout of a tape, and their replay in any scalar type.

pub(crate) mod batch;
pub(crate) mod forward;
pub(crate) mod layout;
pub(crate) mod point;
pub(crate) mod tape;
pub(crate) mod values;
