//! [`One`], [`Many`]: a trace evaluated at a single point, or at many at once.
//!
//! Points are processed in groups of 8, doubles in groups of 4 if the rows are short. Memory: one number for
//! each slot of the tape and each point of a group, for each width in use.

use crate::native::compiled::Runs;
use crate::native::fused::Called;
use crate::replay::batch::Batch;
use crate::replay::forward::forward;
use crate::replay::tape::{Tape, Transfer};
use crate::replay::values::{Replay, constants};
use crate::routes::results::Results;
use equip_scalar::{Float, InstructionSet, Kernel, Pack};

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
        if self
            .runs(of)
            .run(set, &mut Batch::one(y, &mut *results))
            .is_none()
        {
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

    #[inline]
    fn runs(&mut self, of: &Results) -> &mut Runs {
        (self.runs).get_or_insert_with(|| Runs::new::<T>(|| of.compiled(constants).clone()))
    }

    fn replay(&mut self, of: &Results) -> &mut Replay<T> {
        self.replay.get_or_insert_with(|| Replay::new(of.one()))
    }
}

/// Uses machine code; without it the tape over lanes, or point by point for types without lanes. Workspace is
/// allocated only for what is used.
#[derive(Debug, Clone)]
pub(crate) struct Many<T: Float> {
    pub(super) one: One<T>,
    four: Option<Replay<T::Pack<4>>>,
    eight: Option<Replay<T::Pack<8>>>,
}

impl<T: Float> Many<T> {
    pub(crate) fn new() -> Self {
        Many {
            one: One::new(),
            four: None,
            eight: None,
        }
    }

    pub(crate) fn run(&mut self, set: InstructionSet, of: &Results, mut batch: Batch<T>) {
        if self.one.runs(of).run(set, &mut batch).is_some() {
            return;
        }
        if const { T::WIDTH == 1 } {
            return self.one.replay(of).each(of.one(), batch);
        }
        let (tape, batch) = (of.many(), &mut batch);
        if const { T::IS_DOUBLE } && batch.stride <= 4 {
            let replay = self
                .four
                .get_or_insert_with(|| Replay::<T>::new(tape).widened(Pack::splat));
            set.run(&mut Group::<T, 4> {
                tape,
                replay,
                batch,
            });
        } else {
            let replay = self
                .eight
                .get_or_insert_with(|| Replay::<T>::new(tape).widened(Pack::splat));
            set.run(&mut Group::<T, 8> {
                tape,
                replay,
                batch,
            });
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
        self.one.runs(of).without_scratch(set, stride).map(Called)
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
