//! [`Many`]: a recording at many points at once.

use crate::batch::Batch;
use crate::compiled::Runs;
use crate::fused::Called;
use crate::in_lanes::InLanes;
use crate::results::Results;
use crate::values::Replay;
use equip_scalar::{Float, InstructionSet};

/// By machine code; where there is none by the tape over lanes, of floats without lanes point after point.
/// There is room only for what is done.
#[derive(Debug, Clone)]
pub(crate) struct Many<T: Float> {
    runs: Option<Runs>,
    in_lanes: Option<InLanes<T>>,
    one_by_one: Option<Replay<T>>,
}

impl<T: Float> Many<T> {
    pub(crate) fn new() -> Self {
        Many {
            runs: None,
            in_lanes: None,
            one_by_one: None,
        }
    }

    #[inline]
    fn runs(&mut self, of: &Results) -> &mut Runs {
        (self.runs).get_or_insert_with(|| Runs::new::<T>(|| of.compiled().clone()))
    }

    pub(crate) fn run(&mut self, set: InstructionSet, of: &Results, mut batch: Batch<T>) {
        if self.runs(of).run(set, batch.reborrow()).is_some() {
            return;
        }
        let tape = of.many();
        if const { T::WIDTH > 1 } {
            let lanes = self.in_lanes.get_or_insert_with(|| InLanes::new(tape));
            lanes.run(set, tape, &mut batch);
        } else {
            let replay = self.one_by_one.get_or_insert_with(|| Replay::new(tape));
            replay.each(tape, batch);
        }
    }

    /// Machine code for rows of `stride` numbers that can be called from anywhere.
    #[inline]
    pub(crate) fn called(
        &mut self,
        set: InstructionSet,
        of: &Results,
        stride: usize,
    ) -> Option<Called<'_>> {
        self.runs(of).without_scratch(set, stride).map(Called)
    }
}
