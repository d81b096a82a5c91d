//! [`Tape`]: the operations of a recording, laid out for replay.

use crate::recording::op::Op;
use equip_scalar::{Constant, Outside};
use std::ops::Range;
use std::sync::Arc;

/// Terms from which on rounding the partial sums of a sum is worth half of what rounding single terms is.
pub(crate) const LONG: usize = 64;

/// Equal operations without dependence on each other.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) op: Op,
    /// Slots of the results.
    pub(crate) slots: Range<usize>,
    /// First entry in [`Tape::operands`].
    pub(crate) operands: usize,
}

/// Terms of a sum with one sign.
#[derive(Debug, Clone)]
pub(crate) struct Segment {
    pub(crate) minus: bool,
    pub(crate) terms: Range<usize>,
}

/// Components, of the inputs or of the results, side by side and in slots side by side.
#[derive(Debug, Clone)]
pub(crate) struct Transfer {
    pub(crate) components: Range<usize>,
    pub(crate) slots: Range<usize>,
}

impl Transfer {
    /// Appends one component, to the last stretch if it follows that.
    pub(super) fn append(
        transfers: &mut Vec<Transfer>,
        from: usize,
        component: usize,
        slot: usize,
    ) {
        match transfers[from..].last_mut() {
            Some(last) if (last.components.end, last.slots.end) == (component, slot) => {
                last.components.end += 1;
                last.slots.end += 1;
            }
            _ => transfers.push(Transfer {
                components: component..component + 1,
                slots: slot..slot + 1,
            }),
        }
    }
}

/// A part of the replay: inputs are read, runs are done, results are given away, and what later blocks need
/// is kept.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Entry in [`Tape::inputs`].
    pub(crate) inputs: Range<usize>,
    /// Entry in [`Tape::runs`].
    pub(crate) runs: Range<usize>,
    /// Entry in [`Tape::results`].
    pub(crate) results: Range<usize>,
    /// Entry in [`Tape::copies`].
    pub(crate) copies: Range<usize>,
}

/// A recorded energy, in no particular float type.
#[derive(Debug)]
pub(crate) struct Tape {
    pub(crate) constants: Vec<Constant>,
    /// Constants used as exponents, by the index [`Op::Powf`] and [`Op::PowfDerivative`] have after layout.
    pub(crate) exponents: Vec<Constant>,
    pub(crate) functions: Vec<Arc<dyn Outside>>,
    pub(crate) slots: usize,
    /// Runs of what depends on constants only.
    pub(crate) constant_runs: Vec<Run>,
    pub(crate) runs: Vec<Run>,
    pub(crate) blocks: Vec<Block>,
    /// Slots of the operands of all runs.
    pub(crate) operands: Vec<[u32; 2]>,
    /// Slots of the terms of sums.
    pub(crate) terms: Vec<u32>,
    pub(crate) segments: Vec<Segment>,
    /// Entry of each sum in `segments`.
    pub(crate) sums: Vec<Range<usize>>,
    /// Where the inputs go, in the order of the blocks.
    pub(crate) inputs: Vec<Transfer>,
    /// Where the results are, in the order of the blocks.
    pub(crate) results: Vec<Transfer>,
    /// From where to where what later blocks need is copied.
    pub(crate) copies: Vec<[usize; 2]>,
    /// Number of results.
    pub(crate) components: usize,
    /// Whether a sum has many terms.
    pub(crate) has_long_sums: bool,
}

impl Tape {
    /// The sum that a run is, if it has many terms.
    pub(crate) fn long_sum(&self, run: &Run) -> Option<usize> {
        match run.op {
            Op::Sum(k) => Some(k as usize).filter(|&k| self.terms_of(k) >= LONG),
            _ => None,
        }
    }

    fn terms_of(&self, sum: usize) -> usize {
        let segments = self.segments[self.sums[sum].clone()].iter();
        segments.map(|segment| segment.terms.len()).sum()
    }

    /// Arithmetic operations and function calls of one replay.
    pub(crate) fn operations(&self) -> usize {
        let own = |run: &Run| match run.op {
            Op::Sum(k) => self.terms_of(k as usize).saturating_sub(1),
            op => op.count() * run.slots.len(),
        };
        self.runs.iter().map(own).sum()
    }
}
