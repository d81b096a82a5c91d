//! A [`DoubleDouble`](super::DoubleDouble) as decimal text.

mod parse;
mod print;
