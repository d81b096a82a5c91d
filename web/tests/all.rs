//! Formulas and their messages, and simulations of them.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

mod messages;
mod reader;
mod simulation;
