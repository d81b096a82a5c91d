//! [`InLanes`]: the closure route at many points at once, the tape replayed over lanes.
//!
//! Points are taken in groups of 8, or of 4 where there is no room for more. Memory: 96 bytes a slot of the tapes.

use crate::batch::Batch;
use crate::replay::forward;
use crate::tape::{Tape, Transfer};
use crate::values::Replay;
use equip_scalar::{Float, InstructionSet, Kernel, Lanes};
use std::any::TypeId;

/// Workspace of both tapes in both widths.
#[derive(Debug, Clone)]
pub(crate) struct InLanes {
    set: InstructionSet,
    gradient: Widths,
    forces: Option<Widths>,
}

#[derive(Debug, Clone)]
struct Widths {
    four: Replay<Lanes<4>>,
    eight: Replay<Lanes<8>>,
}

impl InLanes {
    /// `None` if `T` is not `f64`.
    pub(crate) fn new<T: Float>(gradient: &Tape, forces: Option<&Tape>) -> Option<Self> {
        (TypeId::of::<T>() == TypeId::of::<f64>()).then(|| InLanes {
            set: InstructionSet::best(),
            gradient: Widths::new(gradient),
            forces: forces.map(Widths::new),
        })
    }

    pub(crate) fn set_instruction_set(&mut self, set: InstructionSet) {
        self.set = set;
    }

    pub(crate) fn gradients(&mut self, tape: &Tape, batch: Option<Batch>) {
        if let Some(batch) = batch {
            self.gradient.run(self.set, tape, batch);
        }
    }

    pub(crate) fn forces(&mut self, tape: &Tape, batch: Option<Batch>) {
        if let (Some(batch), Some(forces)) = (batch, &mut self.forces) {
            forces.run(self.set, tape, batch);
        }
    }
}

impl Widths {
    fn new(tape: &Tape) -> Self {
        Widths {
            four: Replay::lanes(tape),
            eight: Replay::lanes(tape),
        }
    }

    fn run(&mut self, set: InstructionSet, tape: &Tape, batch: Batch) {
        if batch.stride <= 4 {
            let replay = &mut self.four;
            set.run(&mut Group {
                tape,
                replay,
                batch,
            });
        } else {
            let replay = &mut self.eight;
            set.run(&mut Group {
                tape,
                replay,
                batch,
            });
        }
    }
}

/// A tape and the points to replay it at.
struct Group<'a, const L: usize> {
    tape: &'a Tape,
    replay: &'a mut Replay<Lanes<L>>,
    batch: Batch<'a>,
}

impl<const L: usize> Kernel for Group<'_, L> {
    type Output = ();

    #[inline(always)]
    fn run(&mut self) {
        let Group {
            tape,
            replay,
            batch,
        } = self;
        let (values, exponents) = (&mut replay.values, &replay.exponents);
        let stride = batch.stride;
        let mut at = 0;
        while at < batch.count {
            for block in &tape.blocks {
                for Transfer { components, slots } in &tape.inputs[block.inputs.clone()] {
                    let rows = batch.states[components.start * stride..].chunks_exact(stride);
                    for (place, row) in values[slots.clone()].iter_mut().zip(rows) {
                        *place = Lanes::load(&row[at..]);
                    }
                }
                forward(tape, &tape.runs[block.runs.clone()], exponents, values);
                for Transfer { components, slots } in &tape.results[block.results.clone()] {
                    let rows = &mut batch.gradients[components.start * stride..];
                    let rows = rows.chunks_exact_mut(stride);
                    for (value, row) in values[slots.clone()].iter().zip(rows) {
                        value.store(&mut row[at..]);
                    }
                }
            }
            at += L;
        }
    }
}
