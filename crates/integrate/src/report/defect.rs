//! [`Defect`]: how far a quantity has strayed along a run.

use equip_autodiff::{Evaluate, Hamiltonian, System};
use equip_scalar::Float;
use equip_solver::Invariant;

/// How far a quantity has strayed from its value at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Defect<T> {
    /// Name of the quantity.
    pub name: String,
    /// Its value at the start, in its own unit.
    pub start: T,
    /// Largest absolute difference from it over all steps.
    pub max: T,
    /// Difference at the last step.
    pub end: T,
}

impl<T: Float> Defect<T> {
    pub(crate) fn new(name: &str) -> Self {
        Defect {
            name: name.to_owned(),
            start: T::int(0),
            max: T::int(0),
            end: T::int(0),
        }
    }

    /// The quantity is compared with `start` from now on.
    pub(crate) fn begin(&mut self, start: T) {
        (self.start, self.end) = (start, T::int(0));
    }

    pub(crate) fn see(&mut self, difference: T) {
        self.end = difference;
        // Once infinite or NaN, always.
        if self.max.is_finite() && !(difference.abs() <= self.max) {
            self.max = difference.abs();
        }
    }
}

/// An invariant being watched in one float type.
#[derive(Debug)]
pub(crate) struct Watched<T: Float> {
    pub(crate) defect: Defect<T>,
    evaluator: <Hamiltonian as System>::Evaluator<T>,
}

impl<T: Float> Watched<T> {
    pub(crate) fn new(invariant: &Invariant) -> Self {
        Watched {
            defect: Defect::new(invariant.name()),
            evaluator: invariant.function().evaluator::<T>(),
        }
    }

    /// The quantity is compared with its value at `y` from now on.
    pub(crate) fn begin(&mut self, y: &[T]) {
        self.defect.begin(self.evaluator.compensated_value(y));
    }

    /// The function.
    pub(crate) fn function_mut(&mut self) -> &mut <Hamiltonian as System>::Evaluator<T> {
        &mut self.evaluator
    }

    pub(crate) fn see(&mut self, y: &[T]) {
        let value = self.evaluator.compensated_value(y);
        self.defect.see(value - self.defect.start);
    }
}
