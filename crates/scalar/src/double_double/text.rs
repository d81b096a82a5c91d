//! A [`DoubleDouble`](super::DoubleDouble) as decimal text.

pub(crate) mod parse;
pub(crate) mod print;
