//! The options of steps by a tolerance.

use crate::options::integrator::{Integrator, StepSizes};
use crate::options::method::Method;
use crate::options::tolerance::Tolerance;
use equip_scalar::Float;

impl Method {
    /// An integrator with variable steps. The error of each step is about `tolerance`, relative to the
    /// change over the step and for each component separately, so neither units nor masses matter. Energy
    /// and quadratic invariants are conserved for any sequence of steps. If the frequencies of the motion
    /// depend on the conserved quantities alone, as in Kepler's problem, position errors grow linearly in
    /// time.
    ///
    /// All sizes are positive, also in a run backward in time. A step that fails is shortened by the step
    /// size control instead of being halved. The states of [`Integrator::output_at`] come from dense output,
    /// with the accuracy of the steps.
    ///
    /// The error estimate uses the decay of Legendre coefficients. `docs/which-steps.md` compares measured
    /// errors with tolerances.
    pub fn tolerance<T: Float>(self, tolerance: T) -> Integrator<T> {
        let sizes = Tolerance {
            tolerance,
            relative: [Vec::new(), Vec::new()],
            absolute: [Vec::new(), Vec::new()],
            first_step: None,
            min_step: T::int(0),
            max_step: T::INFINITY,
            max_steps: u64::MAX,
        };
        let mut integrator = Integrator::new(self, StepSizes::Tolerance(sizes));
        integrator.options.max_halvings = 0;
        integrator
    }
}

/// The options of steps by a tolerance.
impl<T: Float> Integrator<T> {
    /// The relative errors of a step, compared with the change over the step, for components that are to
    /// differ from the tolerance. Each slice has one entry for each of the m positions or momenta, or one
    /// entry for all; if it is empty, the tolerance applies.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::Equip;
    ///
    /// // Two springs: an error of 1e-4 per step is allowed for the fast one, 1e-12 for the slow one.
    /// let springs = Hamiltonian::new(2, |q, p| {
    ///     0.5 * (p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + 100.0 * q[1] * q[1])
    /// })?;
    /// let apart = [1e-12, 1e-4];
    /// let options = Equip::stages(4).tolerance(1e-12).rtol(&apart, &apart);
    /// let run = options.integrate(&springs, &[1.0, 1e-3], &[0.0, 0.0], 0.0..=10.0)?;
    /// assert!((run.last().1[0] - 10f64.cos()).abs() < 1e-11);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn rtol(self, positions: &[T], momenta: &[T]) -> Self {
        self.by_tolerance("rtol", |sizes| {
            sizes.relative = [positions.to_vec(), momenta.to_vec()]
        })
    }

    /// The absolute errors of a step, in the units of positions and momenta, in addition to the relative
    /// ones. Each slice has one entry for each of the m components, or one entry for all. Zero by default.
    ///
    /// The admissible error of component c in a step is `rtol` × its change over the step + `atol`.
    #[must_use]
    pub fn atol(self, positions: &[T], momenta: &[T]) -> Self {
        self.by_tolerance("atol", |sizes| {
            sizes.absolute = [positions.to_vec(), momenta.to_vec()]
        })
    }

    /// The size of the first step. By default it follows from the motion at the start. It is at least the
    /// resolution of time.
    #[must_use]
    pub fn first_step(self, h: T) -> Self {
        self.by_tolerance("first_step", |sizes| sizes.first_step = Some(h))
    }

    /// The smallest step. A run that needs a smaller one ends with
    /// [`StepBelowMinimum`](crate::IntegrateError::StepBelowMinimum). Zero by default, so that the resolution
    /// of time is the limit. A step that is shortened to meet the end of the run may be smaller.
    #[must_use]
    pub fn min_step(self, h: T) -> Self {
        self.by_tolerance("min_step", |sizes| sizes.min_step = h)
    }

    /// The largest step. No limit by default.
    #[must_use]
    pub fn max_step(self, h: T) -> Self {
        self.by_tolerance("max_step", |sizes| sizes.max_step = h)
    }

    /// The maximum number of steps of a run. A run that needs more ends with
    /// [`StepLimit`](crate::IntegrateError::StepLimit). No limit by default.
    #[must_use]
    pub fn max_steps(self, steps: u64) -> Self {
        self.by_tolerance("max_steps", |sizes| sizes.max_steps = steps)
    }

    fn by_tolerance(mut self, option: &'static str, set: impl FnOnce(&mut Tolerance<T>)) -> Self {
        match &mut self.sizes {
            StepSizes::Tolerance(sizes) => set(sizes),
            StepSizes::Fixed(_) => self.options.misplaced = Some(option),
        }
        self
    }
}
