//! [`Conserved`]: how far a quantity has strayed along a run.

use crate::time::visible::visible;
use equip_autodiff::{Evaluator, StateFunction};
use equip_scalar::Float;
use equip_solver::Invariant;

/// How far a quantity has strayed from its value at the start.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Conserved<T> {
    /// Name of the quantity.
    pub name: String,
    /// Its value at the start, in its own unit.
    pub start: T,
    /// Largest absolute difference from it over all steps.
    pub max: T,
    /// Difference at the last step.
    pub end: T,
}

impl<T: Float> Conserved<T> {
    pub(crate) fn new(name: &str) -> Self {
        Conserved {
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
    pub(crate) conserved: Conserved<T>,
    function: StateFunction<T>,
}

impl<T: Float> Watched<T> {
    pub(crate) fn new(invariant: &Invariant) -> Self {
        Watched {
            conserved: Conserved::new(invariant.name()),
            function: invariant.function().function(),
        }
    }

    /// The quantity is compared with its value at `y` and time `t` from now on.
    pub(crate) fn begin(&mut self, t: T, y: &[T]) {
        let value = self.value(t, y);
        self.conserved.begin(value);
    }

    /// What evaluates the function, and the state as that takes it.
    pub(crate) fn evaluator_at(&mut self, t: T, y: &[T]) -> (&mut Evaluator<T>, &[T]) {
        let (q, p) = visible(y, self.function.degrees_of_freedom());
        self.function.evaluator_at(t, q, p)
    }

    pub(crate) fn see(&mut self, t: T, y: &[T]) {
        let value = self.value(t, y);
        self.conserved.see(value - self.conserved.start);
    }

    fn value(&mut self, t: T, y: &[T]) -> T {
        let (q, p) = visible(y, self.function.degrees_of_freedom());
        self.function.compensated_value(t, q, p)
    }
}
