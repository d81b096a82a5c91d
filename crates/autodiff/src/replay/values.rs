//! [`Replay`]: the values of all slots of a tape, in one scalar type.

use crate::recording::graph::Graph;
use crate::replay::batch::Batch;
use crate::replay::forward::{CompensatedSum, forward};
use crate::replay::layout::{Blocks, layout};
use crate::replay::tape::{Block, Run, Tape, Transfer};
use equip_scalar::{Constant, Float, InstructionSet, Scalar};

/// Workspace for replaying one tape. Constants, and values that depend on constants only, are computed on
/// construction.
#[derive(Debug, Clone)]
pub(crate) struct Replay<S> {
    pub(crate) values: Vec<S>,
    pub(crate) exponents: Vec<Constant>,
    /// The results of the last replay. Unused in lanes, where results are written to their target directly.
    pub(crate) results: Vec<S>,
}

impl<T: Float> Replay<T> {
    pub(crate) fn new(tape: &Tape) -> Self {
        let exponents: Vec<Constant> = tape
            .exponents
            .iter()
            .map(|c| resolved(c.to::<T>()))
            .collect();
        let zero = T::int(0);
        let mut values: Vec<T> = tape.constants.iter().map(|c| c.to()).collect();
        values.resize(tape.slots, zero);
        forward(tape, &tape.constant_runs, &exponents, &mut values);
        Replay {
            values,
            exponents,
            results: vec![zero; tape.components],
        }
    }

    /// The results for these inputs, with long sums compensated.
    pub(crate) fn run_compensated(
        &mut self,
        set: InstructionSet,
        tape: &Tape,
        input: impl Fn(usize) -> T,
    ) -> &[T] {
        for block in &tape.blocks {
            self.read(tape, block, &input);
            for run in &tape.runs[block.runs.clone()] {
                match tape.long_sum(run) {
                    Some(sum) => set.run(&mut CompensatedSum {
                        tape,
                        sum,
                        run,
                        values: &mut self.values,
                    }),
                    None => self.forward(tape, std::slice::from_ref(run)),
                }
            }
            self.give(tape, block);
            self.keep(tape, block);
        }
        &self.results
    }

    /// Replays at each point of a batch that is stored component by component.
    pub(crate) fn each(&mut self, tape: &Tape, batch: Batch<T>) {
        let stride = batch.stride;
        for i in 0..batch.count {
            let found = self.run(tape, |k| batch.states[k * stride + i]);
            for (row, &result) in batch.gradients.chunks_exact_mut(stride).zip(found) {
                row[i] = result;
            }
        }
    }
}

impl<S> Replay<S> {
    /// The same replay on other numbers.
    pub(crate) fn widened<W>(self, wide: impl Fn(S) -> W) -> Replay<W> {
        Replay {
            results: self.results.into_iter().map(&wide).collect(),
            values: self.values.into_iter().map(wide).collect(),
            exponents: self.exponents,
        }
    }
}

impl<S: Scalar> Replay<S> {
    /// The results for these inputs.
    pub(crate) fn run(&mut self, tape: &Tape, input: impl Fn(usize) -> S) -> &[S] {
        for block in &tape.blocks {
            self.read(tape, block, &input);
            self.forward(tape, &tape.runs[block.runs.clone()]);
            self.give(tape, block);
            self.keep(tape, block);
        }
        &self.results
    }

    /// Copies the values that later blocks need.
    #[inline(always)]
    pub(crate) fn keep(&mut self, tape: &Tape, block: &Block) {
        for &[from, to] in &tape.copies[block.copies.clone()] {
            self.values[to] = self.values[from];
        }
    }

    #[inline(always)]
    fn read(&mut self, tape: &Tape, block: &Block, input: &impl Fn(usize) -> S) {
        for Transfer { components, slots } in &tape.inputs[block.inputs.clone()] {
            let places = &mut self.values[slots.clone()];
            for (place, k) in places.iter_mut().zip(components.clone()) {
                *place = input(k);
            }
        }
    }

    #[inline(always)]
    fn give(&mut self, tape: &Tape, block: &Block) {
        for Transfer { components, slots } in &tape.results[block.results.clone()] {
            self.results[components.clone()].copy_from_slice(&self.values[slots.clone()]);
        }
    }

    // Compiled once for each scalar type, not for each type of input.
    #[inline(never)]
    fn forward(&mut self, tape: &Tape, runs: &[Run]) {
        forward(tape, runs, &self.exponents, &mut self.values);
    }
}

/// The number in the form of a constant that is read fastest.
fn resolved<T: Float>(x: T) -> Constant {
    let parts = x.expansion();
    match parts[1..].iter().all(|&part| part == 0.0) {
        true => Constant::double(parts[0]),
        false => Constant::from_expansion(parts),
    }
}

/// The nodes that depend on constants only, and their values.
pub(crate) fn constants(graph: &Graph) -> Vec<(u32, f64)> {
    let (constants, nodes) = graph.constants_only();
    let tape = layout(&constants, Blocks::One);
    let mut replay = Replay::<f64>::new(&tape);
    let numbers = replay.run(&tape, |_| 0.0);
    nodes.into_iter().zip(numbers.iter().copied()).collect()
}
