//! Further quantities to watch along a run.

use equip_autodiff::{Evaluate, Hamiltonian, System};
use equip_scalar::Float;

/// A named function of the state, recorded like an energy, whose change along the run the certificate shows.
///
/// Quadratic invariants of the flow (angular and linear momentum, norms) are kept by every method here for any step;
/// others are measured only.
#[derive(Debug, Clone)]
pub struct Invariant {
    name: String,
    function: Hamiltonian,
}

impl Invariant {
    /// A quantity I(q, p) under a name, recorded by [`Hamiltonian::new`].
    pub fn new(name: impl Into<String>, function: Hamiltonian) -> Self {
        Invariant {
            name: name.into(),
            function,
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The function.
    pub fn function(&self) -> &Hamiltonian {
        &self.function
    }

    /// Whether it is at most quadratic, and so kept for free if the flow keeps it.
    pub fn is_quadratic(&self) -> bool {
        self.function.structure().is_quadratic()
    }
}

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
    pub(crate) fn new(name: &str, start: T) -> Self {
        Defect {
            name: name.to_owned(),
            start,
            max: T::int(0),
            end: T::int(0),
        }
    }

    pub(crate) fn see(&mut self, difference: T) {
        self.end = difference;
        if !(difference.abs() <= self.max) {
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
    pub(crate) fn new(invariant: &Invariant, y: &[T]) -> Self {
        let mut evaluator = invariant.function.evaluator::<T>();
        let start = evaluator.compensated_value(y);
        Watched {
            defect: Defect::new(&invariant.name, start),
            evaluator,
        }
    }

    pub(crate) fn see(&mut self, y: &[T]) {
        let value = self.evaluator.compensated_value(y);
        self.defect.see(value - self.defect.start);
    }
}
