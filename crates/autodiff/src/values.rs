//! [`Replay`]: the values of all slots of a tape, in one kind of number.

use crate::replay::forward;
use crate::tangent::Tangent;
use crate::tape::Tape;
use equip_scalar::{Constant, Float, Lanes, Piecewise};

/// Workspace for replaying one tape. Constants, and what depends on them alone, are computed when it is made.
#[derive(Debug, Clone)]
pub(crate) struct Replay<S> {
    pub(crate) values: Vec<S>,
    pub(crate) exponents: Vec<Constant>,
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
        Replay { values, exponents }
    }

    /// Whether a constant is NaN.
    pub(crate) fn has_nan(&self) -> bool {
        let exponents = self.exponents.iter().map(|c| c.to());
        let mut constants = self.values.iter().copied().chain(exponents);
        constants.any(|x: T| Float::is_nan(x))
    }

    /// Replays at each point of a batch that stands component by component.
    pub(crate) fn each(
        &mut self,
        tape: &Tape,
        states: &[T],
        results: &mut [T],
        stride: usize,
        count: usize,
    ) {
        for i in 0..count {
            self.set(tape, states.chunks_exact(stride).map(|row| row[i]));
            for (k, row) in results.chunks_exact_mut(stride).enumerate() {
                row[i] = self.result(tape, k);
            }
        }
    }
}

impl<T: Float, const C: usize> Replay<Tangent<T, C>> {
    pub(crate) fn tangents(tape: &Tape) -> Self {
        Replay::<T>::new(tape).widened(Tangent::fixed)
    }
}

impl<const N: usize> Replay<Lanes<N>> {
    pub(crate) fn lanes(tape: &Tape) -> Self {
        Replay::<f64>::new(tape).widened(Lanes::splat)
    }
}

impl<S> Replay<S> {
    fn widened<W>(self, wide: impl Fn(S) -> W) -> Replay<W> {
        Replay {
            values: self.values.into_iter().map(wide).collect(),
            exponents: self.exponents,
        }
    }
}

impl<S: Piecewise> Replay<S> {
    /// Replays for the given inputs; of fewer inputs than the tape has, the others keep their values.
    pub(crate) fn set(&mut self, tape: &Tape, inputs: impl Iterator<Item = S>) {
        let slots = &mut self.values[tape.inputs.clone()];
        slots
            .iter_mut()
            .zip(inputs)
            .for_each(|(slot, input)| *slot = input);
        self.run(tape);
    }

    #[inline(never)]
    fn run(&mut self, tape: &Tape) {
        forward(tape, &tape.runs, &self.exponents, &mut self.values);
    }

    #[inline(always)]
    pub(crate) fn result(&self, tape: &Tape, k: usize) -> S {
        self.values[tape.results[k] as usize]
    }
}

/// The number as the constant that is cheapest to read.
fn resolved<T: Float>(x: T) -> Constant {
    match x.expansion() {
        [head, 0.0, 0.0, 0.0] => Constant::Double(head),
        parts => Constant::Extended(parts),
    }
}
