//! [`Many`]: a recording at many points at once.

use crate::batch::Batch;
use crate::compiled::{Compiled, Runs};
use crate::fused::Called;
use crate::in_lanes::InLanes;
use crate::tape::Tape;
use crate::values::Replay;
use equip_scalar::{Float, InstructionSet};
use std::sync::Arc;

/// By machine code; where there is none by the tape over lanes, of floats without lanes point after point.
/// There is room only for what is done.
#[derive(Debug, Clone)]
pub(crate) struct Many<T: Float> {
    runs: Runs,
    in_lanes: Option<InLanes<T>>,
    one_by_one: Option<Replay<T>>,
}

impl<T: Float> Many<T> {
    pub(crate) fn new(compiled: &Option<Arc<Compiled>>, set: InstructionSet, tape: &Tape) -> Self {
        let mut many = Many {
            runs: Runs::new::<T>(compiled),
            in_lanes: None,
            one_by_one: None,
        };
        if !many.runs.has_code(set) {
            many.prepare(tape);
        }
        many
    }

    fn prepare(&mut self, tape: &Tape) {
        if T::WIDTH > 1 {
            self.in_lanes.get_or_insert_with(|| InLanes::new(tape));
        } else {
            self.one_by_one.get_or_insert_with(|| Replay::new(tape));
        }
    }

    /// By machine code alone; `None` if there is none.
    #[inline]
    pub(crate) fn run_code(&mut self, set: InstructionSet, batch: Batch<T>) -> Option<()> {
        self.runs.run(set, batch)
    }

    pub(crate) fn run(&mut self, set: InstructionSet, tape: &Tape, mut batch: Batch<T>) {
        if self.run_code(set, batch.reborrow()).is_some() {
            return;
        }
        self.prepare(tape);
        if let Some(lanes) = &mut self.in_lanes {
            lanes.run(set, tape, &mut batch);
        } else if let Some(replay) = &mut self.one_by_one {
            replay.each(tape, batch);
        }
    }

    /// Machine code for rows of `stride` numbers that can be called from anywhere.
    #[inline]
    pub(crate) fn called(&mut self, set: InstructionSet, stride: usize) -> Option<Called<'_>> {
        self.runs.without_scratch(set, stride).map(Called)
    }
}
