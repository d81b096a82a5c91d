//! [`Adaptive`]: steps that follow a tolerance.

use crate::control::estimate::Allowed;
use crate::error::IntegrateError;
use crate::options::common::check;
use crate::options::integrator::Integrator;
use crate::options::method::Method;
use equip_scalar::Float;
use equip_solver::MAX_STAGES;

/// A method with variable steps that follow a tolerance. Energy and quadratic invariants are kept for any
/// sequence of steps, so variable steps cost neither; position errors then grow linearly in time where others
/// grow quadratically.
///
/// All sizes are positive, also of a run that goes back in time. A step that fails is shortened, not halved.
/// [`Integrator::reach`] is asked only when shorter steps do not help either; [`Integrator::output_at`] is
/// served from dense output, with the accuracy of the steps.
pub type Adaptive<T> = Integrator<T, Tolerance<T>>;

/// Sizes by a tolerance, within bounds.
#[derive(Debug, Clone)]
pub struct Tolerance<T> {
    pub(crate) tolerance: T,
    pub(crate) relative: [Vec<T>; 2],
    pub(crate) absolute: [Vec<T>; 2],
    pub(crate) first_step: Option<T>,
    pub(crate) min_step: T,
    pub(crate) max_step: T,
    pub(crate) max_steps: u64,
}

/// Names of the options.
const RELATIVE: [&str; 2] = ["rtol (q)", "rtol (p)"];
const ABSOLUTE: [&str; 2] = ["atol (q)", "atol (p)"];

/// Fewest stages with coefficients to estimate an error from.
const MIN_STAGES: usize = 2;

impl Method {
    /// An integrator with variable steps whose error is about `tolerance` in each step, relative to the
    /// motion within the step and of each component for itself: neither units nor masses matter.
    ///
    /// The estimate behind it is from the decay of Legendre coefficients; `docs/which-steps.md` shows
    /// measured errors and tolerances.
    pub fn tolerance<T: Float>(self, tolerance: T) -> Adaptive<T> {
        let sizes = Tolerance {
            tolerance,
            relative: [Vec::new(), Vec::new()],
            absolute: [Vec::new(), Vec::new()],
            first_step: None,
            min_step: T::int(0),
            max_step: T::INFINITY,
            max_steps: u64::MAX,
        };
        let mut integrator = Integrator::new(self, sizes);
        integrator.options.max_halvings = 0;
        integrator
    }
}

impl<T: Float> Adaptive<T> {
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
    pub fn rtol(mut self, positions: &[T], momenta: &[T]) -> Self {
        self.sizes.relative = [positions.to_vec(), momenta.to_vec()];
        self
    }

    /// Errors of a step that are allowed in addition to those relative to its motion, in the units of
    /// positions and momenta: of each of the m components, or one for all of them. Zero by default.
    ///
    /// With it a step may be off in component c by `rtol` × its motion in the step + `atol`.
    #[must_use]
    pub fn atol(mut self, positions: &[T], momenta: &[T]) -> Self {
        self.sizes.absolute = [positions.to_vec(), momenta.to_vec()];
        self
    }

    /// Size of the first step; chosen from the motion at the start by default. Raised to the resolution of
    /// time where it is below.
    #[must_use]
    pub fn first_step(mut self, h: T) -> Self {
        self.sizes.first_step = Some(h);
        self
    }

    /// Smallest step; a run that needs a smaller one ends with [`IntegrateError::StepBelowMinimum`]. Zero by
    /// default: the resolution of time is the limit. A step cut to reach the end of the run may be smaller.
    #[must_use]
    pub fn min_step(mut self, h: T) -> Self {
        self.sizes.min_step = h;
        self
    }

    /// Largest step; no limit by default.
    #[must_use]
    pub fn max_step(mut self, h: T) -> Self {
        self.sizes.max_step = h;
        self
    }

    /// Most steps of a run; a run that needs more ends with [`IntegrateError::StepLimit`]. No limit by
    /// default.
    #[must_use]
    pub fn max_steps(mut self, steps: u64) -> Self {
        self.sizes.max_steps = steps;
        self
    }
}

impl<T: Float> Tolerance<T> {
    pub(crate) fn validate(&self, method: Method) -> Result<(), IntegrateError<T>> {
        let stages = method.degree();
        if stages < MIN_STAGES && method.stage_count() > stages {
            return Err(IntegrateError::NoErrorEstimate);
        }
        if stages < MIN_STAGES {
            return Err(IntegrateError::StagesOutOfRange {
                stages,
                min: MIN_STAGES,
                max: MAX_STAGES,
            });
        }
        let zero = T::int(0);
        let finite = |x: T| x > zero && x.is_finite();
        let relative = |name, error| {
            check(
                error >= T::EPSILON && error <= T::ratio(1, 100),
                name,
                error,
                "between the relative precision of the numbers and 1/100",
            )
        };
        relative("tolerance", self.tolerance)?;
        for (errors, name) in self.relative.iter().zip(RELATIVE) {
            errors.iter().try_for_each(|&error| relative(name, error))?;
        }
        for (errors, name) in self.absolute.iter().zip(ABSOLUTE) {
            for &error in errors {
                let ok = error >= zero && error.is_finite();
                check(ok, name, error, "finite and not negative")?;
            }
        }
        let first = self.first_step.unwrap_or(T::int(1));
        check(finite(first), "first_step", first, "positive and finite")?;
        let (min, max) = (self.min_step, self.max_step);
        check(
            min >= zero && min.is_finite(),
            "min_step",
            min,
            "finite and not negative",
        )?;
        check(
            max > zero && max >= min,
            "max_step",
            max,
            "positive and not below min_step",
        )?;
        check(self.max_steps > 0, "max_steps", zero, "1 or more")?;
        Ok(())
    }

    /// The smallest relative error that any component is to have.
    pub(crate) fn tightest(&self) -> T {
        let of_group = |given: &Vec<T>| match given.as_slice() {
            [] => self.tolerance,
            given => given.iter().fold(T::INFINITY, |a, &x| a.min(x)),
        };
        let [q, p] = &self.relative;
        of_group(q).min(of_group(p))
    }

    /// What a step may be off, of all components: `pairs` positions and as many momenta of which the first
    /// `m` are the user's. None if it is the tolerance of their motion.
    pub(crate) fn allowed(
        &self,
        m: usize,
        pairs: usize,
    ) -> Result<Option<Allowed<T>>, IntegrateError<T>> {
        let fill = |given: &[Vec<T>; 2], otherwise: T, names: [&'static str; 2]| {
            let mut all = vec![otherwise; 2 * pairs];
            let groups = all.chunks_exact_mut(pairs).zip(given);
            for ((all, errors), what) in groups.zip(names) {
                match errors.as_slice() {
                    [] => {}
                    [one] => all[..m].fill(*one),
                    errors if errors.len() == m => all[..m].copy_from_slice(errors),
                    errors => {
                        return Err(IntegrateError::WrongLength {
                            what,
                            expected: m,
                            found: errors.len(),
                        });
                    }
                }
            }
            Ok(all)
        };
        let zero = T::int(0);
        let allowed = Allowed {
            relative: fill(&self.relative, self.tolerance, RELATIVE)?,
            absolute: fill(&self.absolute, zero, ABSOLUTE)?,
        };
        let is_plain = self.absolute.iter().flatten().all(|&x| x == zero)
            && (self.relative.iter().flatten()).all(|&x| x == self.tolerance);
        Ok((!is_plain).then_some(allowed))
    }
}
