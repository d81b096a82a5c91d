//! Tangent maps and indicators of chaos along a [`Stepper`].

use crate::error::IntegrateError;
use crate::steppers::stepper::Stepper;
use crate::tangent::chaos::Chaos;
use crate::tangent::tangent_map::TangentMap;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

impl<T: Float> TangentMap<T> {
    /// Follows `run`, made of the same `system`, from its next step on.
    pub fn new(system: &Hamiltonian, run: &mut Stepper<T>) -> Self {
        Self::of(system, &mut run.inner)
    }

    /// Makes the steps of `run` to the time `t`, forward or back, and propagates `deviations`, one after the
    /// other, over every one of them.
    ///
    /// # Errors
    /// Those of the run's own `advance_to`, and those of [`propagate`](Self::propagate).
    ///
    /// # Panics
    /// When the length of `deviations` is no multiple of that of one.
    pub fn advance_to(
        &mut self,
        run: &mut Stepper<T>,
        t: T,
        deviations: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        self.check_followed(&run.inner, 0)?;
        while run.advance_towards(t)? {
            self.propagate(run, deviations)?;
        }
        Ok(())
    }

    /// Propagates `deviations`, one after the other, over the step that `run` made last.
    ///
    /// # Errors
    /// [`IntegrateError::Singular`] if the linearised stages cannot be solved for; the step could then not
    /// have been made by Newton's method either. [`IntegrateError::StepsNotFollowed`] if the run has made
    /// several steps since deviations were last propagated.
    ///
    /// # Panics
    /// When the length of `deviations` is no multiple of that of one.
    pub fn propagate(
        &mut self,
        run: &Stepper<T>,
        deviations: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        self.propagate_over(&run.inner, deviations)
    }
}

impl<T: Float> Chaos<T> {
    /// Follows `run`, made of the same `system`, from now on, with a deviation of any length but zero (2m
    /// components, time not counted).
    pub fn new(system: &Hamiltonian, run: &mut Stepper<T>, deviation: &[T]) -> Self {
        Self::of(system, &mut run.inner, deviation)
    }

    /// Sees the step that `run` made last.
    ///
    /// # Errors
    /// Those of [`TangentMap::propagate`].
    pub fn see(&mut self, run: &Stepper<T>) -> Result<(), IntegrateError<T>> {
        self.see_step(&run.inner)
    }

    /// Makes the steps of `run` to the time `t`, and sees every one of them.
    ///
    /// # Errors
    /// Those of the run's own `advance_to`, and those of [`see`](Self::see).
    pub fn advance_to(&mut self, run: &mut Stepper<T>, t: T) -> Result<(), IntegrateError<T>> {
        while run.advance_towards(t)? {
            self.see(run)?;
        }
        Ok(())
    }
}
