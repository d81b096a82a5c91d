//! [`One`]: a trace evaluated at a single point.

use crate::native::compiled::Runs;
use crate::replay::batch::Batch;
use crate::replay::values::{Replay, constants};
use crate::routes::results::Results;
use equip_scalar::{Float, InstructionSet};

/// Uses machine code, or the tape without it. Workspace is allocated only for what is used.
#[derive(Debug, Clone)]
pub(crate) struct One<T> {
    runs: Option<Runs>,
    replay: Option<Replay<T>>,
}

impl<T: Float> One<T> {
    pub(crate) fn new() -> Self {
        One {
            runs: None,
            replay: None,
        }
    }

    /// The results at y.
    pub(crate) fn run(&mut self, set: InstructionSet, of: &Results, y: &[T], results: &mut [T]) {
        let runs =
            (self.runs).get_or_insert_with(|| Runs::new::<T>(|| of.compiled(constants).clone()));
        if runs.run(set, Batch::one(y, results)).is_none() {
            let tape = of.one();
            results.copy_from_slice(self.replay(of).run(tape, |k| y[k]));
        }
    }

    /// The results at y, with long sums compensated.
    pub(crate) fn run_compensated(
        &mut self,
        set: InstructionSet,
        of: &Results,
        y: &[T],
        results: &mut [T],
    ) {
        let tape = of.one();
        results.copy_from_slice(self.replay(of).run_compensated(set, tape, |k| y[k]));
    }

    fn replay(&mut self, of: &Results) -> &mut Replay<T> {
        self.replay.get_or_insert_with(|| Replay::new(of.one()))
    }
}
