//! [`Conserved`]: the error of a conserved quantity along a run.

use crate::time::visible::visible;
use equip_autodiff::{Evaluator, StateFunction};
use equip_scalar::Float;
use equip_solver::Invariant;

/// The difference of a quantity from its value at the start, or after a change of the state.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Conserved<T> {
    /// The name of the quantity.
    pub name: String,
    /// The value at the start, or after the last change of the state, in its own unit.
    pub start: T,
    /// The largest absolute error over all steps.
    pub max: T,
    /// The error at the last step.
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

    /// Sets the reference value.
    pub(crate) fn begin(&mut self, start: T) {
        (self.start, self.end) = (start, T::int(0));
    }

    pub(crate) fn see(&mut self, difference: T) {
        self.end = difference;
        // An infinite error or NaN is final.
        if self.max.is_finite() && !(difference.abs() <= self.max) {
            self.max = difference.abs();
        }
    }
}

/// An invariant that is monitored in one floating-point type.
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

    /// Sets the reference value at `y` and time `t`.
    pub(crate) fn begin(&mut self, t: T, y: &[T]) {
        let value = self.value(t, y);
        self.conserved.begin(value);
    }

    /// The evaluator of the function, and the state in the form that it takes.
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
