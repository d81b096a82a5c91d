//! [`Code`] for processors that no code is made for: there is none.

use crate::Program;
use equip_scalar::{InstructionSet, Lanes};

/// Machine code of a [`Program`], which this processor has none for.
#[derive(Debug)]
pub enum Code {}

impl Code {
    /// `None`.
    pub fn new(_: &Program, _: InstructionSet, _: usize) -> Option<Self> {
        None
    }

    /// Length of the rows.
    pub fn stride(&self) -> usize {
        match *self {}
    }

    /// Scratch that a run needs.
    pub fn scratch(&self) -> usize {
        match *self {}
    }

    /// Runs the program.
    pub fn run(&self, _: &[f64], _: &mut [f64], _: &mut [Lanes<8>], _: usize) {
        match *self {}
    }
}
