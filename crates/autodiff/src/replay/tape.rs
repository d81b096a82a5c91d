//! [`Tape`]: the operations of a trace in the layout of a replay.

use crate::recording::op::Op;
use equip_scalar::{Constant, Outside};
use std::ops::Range;
use std::sync::Arc;

/// The number of terms from which the rounding of the partial sums is at least half of the rounding of the
/// terms.
pub(crate) const LONG: usize = 64;

/// Equal operations that do not depend on each other.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) op: Op,
    /// Slots of the results.
    pub(crate) slots: Range<usize>,
    /// The first entry in [`Tape::operands`].
    pub(crate) operands: usize,
}

/// Consecutive terms of a sum with the same sign.
#[derive(Debug, Clone)]
pub(crate) struct Segment {
    pub(crate) minus: bool,
    pub(crate) terms: Range<usize>,
}

/// Adjacent components of the inputs or of the results, in adjacent slots.
#[derive(Debug, Clone)]
pub(crate) struct Transfer {
    pub(crate) components: Range<usize>,
    pub(crate) slots: Range<usize>,
}

impl Transfer {
    /// Appends one component, to the last range if it is adjacent.
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

/// A part of the replay: read inputs, compute runs, write results, and copy the values that later blocks
/// need.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// The range in [`Tape::inputs`].
    pub(crate) inputs: Range<usize>,
    /// The range in [`Tape::runs`].
    pub(crate) runs: Range<usize>,
    /// The range in [`Tape::results`].
    pub(crate) results: Range<usize>,
    /// The range in [`Tape::copies`].
    pub(crate) copies: Range<usize>,
}

/// A traced energy, independent of the float type.
#[derive(Debug, Default)]
pub(crate) struct Tape {
    pub(crate) constants: Vec<Constant>,
    /// The constants used as exponents, by the index in [`Op::Powf`] and [`Op::PowfDerivative`] after layout.
    pub(crate) exponents: Vec<Constant>,
    pub(crate) functions: Vec<Arc<dyn Outside>>,
    pub(crate) slots: usize,
    /// The runs of operations that depend on constants only.
    pub(crate) constant_runs: Vec<Run>,
    pub(crate) runs: Vec<Run>,
    pub(crate) blocks: Vec<Block>,
    /// The slots of the operands of all runs.
    pub(crate) operands: Vec<[u32; 2]>,
    /// The slots of the terms of sums.
    pub(crate) terms: Vec<u32>,
    pub(crate) segments: Vec<Segment>,
    /// The range of each sum in `segments`.
    pub(crate) sums: Vec<Range<usize>>,
    /// The slots of the inputs, in the order of the blocks.
    pub(crate) inputs: Vec<Transfer>,
    /// The slots of the results, in the order of the blocks.
    pub(crate) results: Vec<Transfer>,
    /// Source and target slots of the values that later blocks need.
    pub(crate) copies: Vec<[usize; 2]>,
    /// The number of results.
    pub(crate) components: usize,
    /// Whether there is a sum with many terms.
    pub(crate) has_long_sums: bool,
}

impl Tape {
    /// The sum of a run, if it has many terms.
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

    /// The number of arithmetic operations and function calls of one replay.
    pub(crate) fn operations(&self) -> usize {
        let own = |run: &Run| match run.op {
            Op::Sum(k) => self.terms_of(k as usize).saturating_sub(1),
            _ => run.slots.len(),
        };
        self.runs.iter().map(own).sum()
    }
}
