//! Stored reference end states.

mod stored;
mod table;

pub(crate) use stored::{Doubles, End, ReferenceData};
pub(crate) use table::ALL;
