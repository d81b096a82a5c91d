//! What an integrator asks of a recorded energy.

use super::recorded::Recorded;
use super::recorded_evaluator::{RecordedEvaluator, ready};
use crate::native::fused::{Fused, Joined, fuse};
use crate::system::{Evaluate, Holds, System};
use crate::{Kinetic, Structure, Switches, WrongGradient};
use equip_scalar::{Float, InstructionSet};

impl System for Recorded {
    type Evaluator<T: Float> = RecordedEvaluator<T>;

    fn structure(&self) -> &Structure {
        &self.shared.structure
    }

    fn switches(&self) -> Switches {
        Switches::of(self.recording())
    }

    fn evaluator<T: Float>(&self) -> RecordedEvaluator<T> {
        (ready::<T>().evaluator)(&self.shared)
    }
}

// All but what is woven into sweeps is compiled with this crate: `crate::routes::recorded_evaluator`.
impl<T: Float> Evaluate<T> for RecordedEvaluator<T> {
    const IS_RECORDED: bool = true;

    fn recorded<'a, H: Holds<'a>>(held: H::With<Self>) -> H::With<Self> {
        held
    }

    fn formula_checksum(&self) -> Option<u64> {
        Some(self.shared.formula_checksum())
    }

    fn value(&mut self, y: &[T]) -> T {
        (ready::<T>().value)(self, y)
    }

    fn gradient(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.value(y)
    }

    fn compensated_value(&mut self, y: &[T]) -> T {
        (ready::<T>().compensated_value)(self, y)
    }

    fn gradient_with_compensated_value(&mut self, y: &[T], gradient: &mut [T]) -> T {
        self.gradients(y, gradient, y.len());
        self.compensated_value(y)
    }

    fn gradient_with_bound(&mut self, y: &[T], gradient: &mut [T]) -> (T, T) {
        (ready::<T>().gradient_with_bound)(self, y, gradient)
    }

    fn gradients(&mut self, states: &[T], gradients: &mut [T], n: usize) {
        (ready::<T>().gradients)(self, states, gradients, n);
    }

    fn gradients_by_component(
        &mut self,
        states: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        (ready::<T>().gradients_by_component)(self, states, gradients, stride, count);
    }

    fn forces_by_component(
        &mut self,
        positions: &[T],
        gradients: &mut [T],
        stride: usize,
        count: usize,
    ) {
        (ready::<T>().forces_by_component)(self, positions, gradients, stride, count);
    }

    #[inline]
    fn fuse_gradients<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let n = 2 * self.shared.structure.degrees_of_freedom;
        let stride = F::GROUPS * N;
        let slopes = (self.gradients).called(self.set, self.shared.gradient(), stride)?;
        fuse!(self.set, n, slopes, task, [2 4])
    }

    #[inline]
    fn fuse_forces<const N: usize, F: Fused<N>>(&mut self, task: &mut F) -> Option<F::Output> {
        let m = self.shared.structure.degrees_of_freedom;
        let stride = F::GROUPS * N;
        let of = self.shared.slopes().forces.as_ref()?;
        let slopes = self.forces.called(self.set, of, stride)?;
        fuse!(self.set, m, slopes, task, [1 2 3 4])
    }

    /// Derived from the recording: there is nothing to compare.
    fn check_gradient(&mut self, _: &[T]) -> Result<(), WrongGradient<T>> {
        Ok(())
    }

    fn kinetic(&mut self) -> Option<Kinetic<T>> {
        (ready::<T>().kinetic)(self)
    }

    fn set_instruction_set(&mut self, set: InstructionSet) {
        self.set = set;
    }

    fn gradient_rounding(&mut self, y: &[T], off: &mut [T]) {
        (ready::<T>().gradient_rounding)(self, y, off);
    }

    fn hessian_vector(&mut self, y: &[T], v: &[T], product: &mut [T]) {
        (ready::<T>().hessian_vector)(self, y, v, product);
    }

    fn hessian(&mut self, y: &[T], entries: &mut [T]) {
        (ready::<T>().hessian)(self, y, entries);
    }

    fn hessians_by_component(
        &mut self,
        states: &[T],
        entries: &mut [T],
        stride: usize,
        count: usize,
    ) {
        (ready::<T>().hessians_by_component)(self, states, entries, stride, count);
    }
}
