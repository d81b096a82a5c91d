//! Many numbers at once, with the instructions that the processor has.

mod instructions;
mod lanes;
mod stages;

pub use instructions::{InstructionSet, Kernel};
pub use lanes::Lanes;
pub use stages::mix_stages;
