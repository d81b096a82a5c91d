//! Many numbers at once, with the vector instructions of the processor.

mod instructions;
mod lanes;
pub mod power;
pub(crate) mod stages;

pub use instructions::{InstructionSet, Kernel};
pub use lanes::Lanes;
