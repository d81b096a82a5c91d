//! Identities, order and precision of the tableaux, each in every float type.
#![allow(clippy::unwrap_used)]

mod common;
mod conditions;
mod hbvm;
mod legendre;
mod nodes;
mod order;
mod skew;
