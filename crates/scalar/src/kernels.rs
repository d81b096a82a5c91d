//! Many numbers at once, with the instructions that the processor has.

mod instructions;
mod lanes;
pub mod power;
pub(crate) mod stages;

pub use instructions::{InstructionSet, Kernel};
pub use lanes::Lanes;
