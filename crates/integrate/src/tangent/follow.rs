//! Tangent maps and indicators of chaos along a [`Stepper`].

use crate::error::IntegrateError;
use crate::steppers::stepper::Stepper;
use crate::tangent::chaos::Chaos;
use crate::tangent::tangent_map::TangentMap;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

impl<T: Float> TangentMap<T> {
    /// Follows `run` from its next step on. `run` must belong to the same `system`.
    pub fn new(system: &Hamiltonian, run: &mut Stepper<T>) -> Self {
        Self::of(system, &mut run.inner)
    }

    /// Advances `run` to the time `t`, forward or backward, and propagates `tangent_vectors`,
    /// concatenated, over every step.
    ///
    /// # Errors
    /// The errors of `advance_to` of the run, and of [`propagate`](Self::propagate).
    ///
    /// # Panics
    /// If the length of `tangent_vectors` is not a multiple of the length of a tangent vector.
    pub fn advance_to(
        &mut self,
        run: &mut Stepper<T>,
        t: T,
        tangent_vectors: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        self.check_followed(&run.inner, 0)?;
        while run.advance_towards(t)? {
            self.propagate(run, tangent_vectors)?;
        }
        Ok(())
    }

    /// Propagates `tangent_vectors`, concatenated, over the last step of `run`.
    ///
    /// # Errors
    /// [`IntegrateError::Singular`] if the linearised stage equations cannot be solved; Newton's method could
    /// then not have solved the step either. [`IntegrateError::StepsNotFollowed`] if the run has made several
    /// steps since the last propagation.
    ///
    /// # Panics
    /// If the length of `tangent_vectors` is not a multiple of the length of a tangent vector.
    pub fn propagate(
        &mut self,
        run: &Stepper<T>,
        tangent_vectors: &mut [T],
    ) -> Result<(), IntegrateError<T>> {
        self.propagate_over(&run.inner, tangent_vectors)
    }
}

impl<T: Float> Chaos<T> {
    /// Follows `run` from now on, with a `tangent_vector` of any length except zero (2m components,
    /// without time). `run` must belong to the same `system`.
    pub fn new(system: &Hamiltonian, run: &mut Stepper<T>, tangent_vector: &[T]) -> Self {
        Self::of(system, &mut run.inner, tangent_vector)
    }

    /// Propagates over the last step of `run`.
    ///
    /// # Errors
    /// The errors of [`TangentMap::propagate`].
    pub fn see(&mut self, run: &Stepper<T>) -> Result<(), IntegrateError<T>> {
        self.see_step(&run.inner)
    }

    /// Advances `run` to the time `t`, and propagates over every step.
    ///
    /// # Errors
    /// The errors of `advance_to` of the run, and of [`see`](Self::see).
    pub fn advance_to(&mut self, run: &mut Stepper<T>, t: T) -> Result<(), IntegrateError<T>> {
        while run.advance_towards(t)? {
            self.see(run)?;
        }
        Ok(())
    }
}
