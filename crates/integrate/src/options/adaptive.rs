//! Options of steps by a tolerance.

use crate::options::integrator::{Integrator, StepSizes};
use crate::options::method::Method;
use crate::options::tolerance::Tolerance;
use equip_scalar::Float;

impl Method {
    /// An integrator with variable steps whose error is about `tolerance` in each step, relative to the
    /// motion within the step and of each component for itself: neither units nor masses matter. Energy and
    /// quadratic invariants are conserved for any sequence of steps; position errors grow linearly in time.
    ///
    /// All sizes are positive, also of a run that goes back in time. A step that fails is shortened, not
    /// halved. [`Integrator::reach`] applies only when shorter steps do not help either;
    /// [`Integrator::output_at`] is served from dense output, with the accuracy of the steps.
    ///
    /// The estimate behind it is from the decay of Legendre coefficients; `docs/which-steps.md` shows
    /// measured errors and tolerances.
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

/// Options of steps by a tolerance.
impl<T: Float> Integrator<T> {
    /// Errors of a step relative to its motion, without a unit, for components that are to have others than
    /// the tolerance: of each of the m positions and momenta, or one for all of them; the tolerance where
    /// empty.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::Equip;
    ///
    /// // Two springs; the quick one may be off by 1e-4 of its motion in a step, the slow one by 1e-12.
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

    /// Errors of a step that are allowed in addition to those relative to its motion, in the units of
    /// positions and momenta: of each of the m components, or one for all of them. Zero by default.
    ///
    /// With it a step may be off in component c by `rtol` × its motion in the step + `atol`.
    #[must_use]
    pub fn atol(self, positions: &[T], momenta: &[T]) -> Self {
        self.by_tolerance("atol", |sizes| {
            sizes.absolute = [positions.to_vec(), momenta.to_vec()]
        })
    }

    /// Size of the first step; chosen from the motion at the start by default. Raised to the resolution of
    /// time where it is below.
    #[must_use]
    pub fn first_step(self, h: T) -> Self {
        self.by_tolerance("first_step", |sizes| sizes.first_step = Some(h))
    }

    /// Smallest step; a run that needs a smaller one ends with
    /// [`StepBelowMinimum`](crate::IntegrateError::StepBelowMinimum). Zero by default: the resolution of time
    /// is the limit. A step cut to reach the end of the run may be smaller.
    #[must_use]
    pub fn min_step(self, h: T) -> Self {
        self.by_tolerance("min_step", |sizes| sizes.min_step = h)
    }

    /// Largest step; no limit by default.
    #[must_use]
    pub fn max_step(self, h: T) -> Self {
        self.by_tolerance("max_step", |sizes| sizes.max_step = h)
    }

    /// Most steps of a run; a run that needs more ends with
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
