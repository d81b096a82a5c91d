//! [`Many`]: a trace evaluated at many points at once.
//!
//! Points are processed in groups of 8. Doubles are processed in groups of 4 if the rows are short, and in
//! groups of 16 if the rows have that length and the tape is short: more points then share the cost of
//! decoding an operation, whereas the values of a long tape would need twice the cache. Memory: one number
//! for each slot of the tape and each point of a group, for each width in use.

use crate::native::compiled::Runs;
use crate::native::fused::Called;
use crate::replay::batch::Batch;
use crate::replay::forward::forward;
use crate::replay::tape::{Tape, Transfer};
use crate::replay::values::{Replay, constants};
use crate::routes::results::Results;
use equip_scalar::{Float, InstructionSet, Kernel, Lanes, Pack};

/// Uses machine code; without it the tape over lanes, or point by point for types without lanes. Workspace is
/// allocated only for what is used.
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
        (self.runs).get_or_insert_with(|| Runs::new::<T>(|| of.compiled(constants).clone()))
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

    /// Machine code for rows of `stride` numbers that needs no scratch memory.
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

/// The largest number of slots of a tape that is replayed at 16 points at once: 64 KiB.
const SHORT: usize = 512;

/// The workspace of one tape for all widths.
#[derive(Debug, Clone)]
struct InLanes<T: Float> {
    four: Option<Replay<T::Pack<4>>>,
    eight: Option<Replay<T::Pack<8>>>,
    /// For doubles, with a short tape.
    sixteen: Option<Replay<Lanes<16>>>,
}

impl<T: Float> InLanes<T> {
    fn new(tape: &Tape) -> Self {
        InLanes {
            four: None,
            eight: None,
            sixteen: (T::IS_DOUBLE && tape.slots <= SHORT).then(|| Replay::packs(tape)),
        }
    }

    fn run(&mut self, set: InstructionSet, tape: &Tape, batch: &mut Batch<T>) {
        let sixteen = self.sixteen.as_mut().filter(|_| batch.stride == 16);
        if let (Some(replay), Some(mut batch)) = (sixteen, batch.in_doubles()) {
            set.run(&mut Group::<f64, 16> {
                tape,
                replay,
                batch: &mut batch,
            });
        } else if const { T::IS_DOUBLE } && batch.stride <= 4 {
            let replay = self.four.get_or_insert_with(|| Replay::packs(tape));
            set.run(&mut Group::<T, 4> {
                tape,
                replay,
                batch,
            });
        } else {
            let replay = self.eight.get_or_insert_with(|| Replay::packs(tape));
            set.run(&mut Group::<T, 8> {
                tape,
                replay,
                batch,
            });
        }
    }
}

/// A tape, and the points at which it is replayed.
struct Group<'a, 'b, T: Float, const L: usize> {
    tape: &'a Tape,
    replay: &'a mut Replay<T::Pack<L>>,
    batch: &'a mut Batch<'b, T>,
}

impl<T: Float, const L: usize> Kernel for Group<'_, '_, T, L> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        let Group {
            tape,
            replay,
            batch,
        } = self;
        let stride = batch.stride;
        let mut at = 0;
        while at < batch.count {
            for block in &tape.blocks {
                for Transfer { components, slots } in &tape.inputs[block.inputs.clone()] {
                    let places = &mut replay.values[slots.clone()];
                    for (place, k) in places.iter_mut().zip(components.clone()) {
                        *place = Pack::load(&batch.states[k * stride..][..stride][at..]);
                    }
                }
                let (values, exponents) = (&mut replay.values, &replay.exponents);
                forward(tape, &tape.runs[block.runs.clone()], exponents, values);
                for Transfer { components, slots } in &tape.results[block.results.clone()] {
                    let values = &replay.values[slots.clone()];
                    for (value, k) in values.iter().zip(components.clone()) {
                        value.store(&mut batch.gradients[k * stride..][..stride][at..]);
                    }
                }
                replay.keep(tape, block);
            }
            at += L;
        }
    }
}
