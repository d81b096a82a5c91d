//! [`Code`] for processors that are not supported: there is none.

use crate::Program;
use equip_scalar::{InstructionSet, Lanes};

/// Machine code of a [`Program`], which does not exist for this processor.
#[derive(Debug)]
pub enum Code {}

impl Code {
    /// `None`.
    pub fn new(_: &Program, _: InstructionSet, _: usize) -> Option<Self> {
        None
    }

    /// The length of a row.
    pub fn stride(&self) -> usize {
        match *self {}
    }

    /// The length of the scratch memory of a run.
    pub fn scratch(&self) -> usize {
        match *self {}
    }

    /// Runs the program.
    pub fn run(&self, _: &[f64], _: &mut [f64], _: &mut [Lanes<8>], _: usize) {
        match *self {}
    }
}
