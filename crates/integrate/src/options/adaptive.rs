//! [`Adaptive`]: steps that follow a tolerance.

use crate::error::IntegrateError;
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
    pub(crate) absolute: [Vec<T>; 2],
    pub(crate) first_step: Option<T>,
    pub(crate) min_step: T,
    pub(crate) max_step: T,
    pub(crate) max_steps: u64,
}

/// Fewest stages with coefficients to estimate an error from.
const MIN_STAGES: usize = 2;

impl Method {
    /// An integrator with variable steps whose error is about `tolerance` in each step, relative to the
    /// motion within the step and of each component for itself: neither units nor masses matter.
    ///
    /// The estimate behind it is from the decay of Legendre coefficients; `docs/which-steps.md` shows
    /// measured errors beside tolerances.
    pub fn tolerance<T: Float>(self, tolerance: T) -> Adaptive<T> {
        let sizes = Tolerance {
            tolerance,
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
    /// Errors of a step that are allowed beside those relative to its motion, in the units of positions and
    /// momenta: of each of the m components, or one for all of them. Zero by default.
    ///
    /// With it a step may be off in component c by `tolerance` × its motion in the step + `atol`.
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
    pub(crate) fn validate(&self, stages: usize) -> Result<(), IntegrateError<T>> {
        if stages < MIN_STAGES {
            return Err(IntegrateError::StagesOutOfRange {
                stages,
                min: MIN_STAGES,
                max: MAX_STAGES,
            });
        }
        let zero = T::int(0);
        let finite = |x: T| x > zero && x.is_finite();
        let check = |ok: bool, option, value, expected| {
            let error = IntegrateError::Option {
                option,
                value,
                expected,
            };
            if ok { Ok(()) } else { Err(error) }
        };
        let tolerance = self.tolerance;
        check(
            tolerance >= T::EPSILON && tolerance <= T::ratio(1, 100),
            "tolerance",
            tolerance,
            "between the relative precision of the numbers and 1/100",
        )?;
        for (errors, name) in self.absolute.iter().zip(["atol (q)", "atol (p)"]) {
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

    /// The absolute errors of all components, `pairs` positions and as many momenta of which the first `m`
    /// are the user's; none if they are all zero.
    pub(crate) fn absolute_errors(
        &self,
        m: usize,
        pairs: usize,
    ) -> Result<Option<Vec<T>>, IntegrateError<T>> {
        let mut all = vec![T::int(0); 2 * pairs];
        let groups = all.chunks_exact_mut(pairs).zip(&self.absolute);
        for ((all, errors), what) in groups.zip(["atol (q)", "atol (p)"]) {
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
        Ok(all.iter().any(|&x| x > T::int(0)).then_some(all))
    }
}
