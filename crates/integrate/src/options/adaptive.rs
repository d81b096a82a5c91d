//! [`Adaptive`]: a method with a tolerance and options, ready to integrate with variable steps.

use crate::error::IntegrateError;
use crate::method::Method;
use crate::options::event::Event;
use crate::options::fixed_step::FixedStep;
use crate::options::record::Record;
use equip_scalar::Float;
use equip_solver::{Invariant, MAX_STAGES, Reach, Preconditioner, StepOptions};

/// A method with variable steps that follow a tolerance. Energy and quadratic invariants are kept for any sequence of steps, so
/// variable steps cost neither; position errors then grow linearly in time where others grow quadratically.
#[derive(Debug, Clone)]
pub struct Adaptive<T: Float> {
    /// The options that do not concern the size of the steps.
    pub(crate) base: FixedStep<T>,
    pub(crate) tolerance: T,
    pub(crate) scales: [Option<T>; 2],
    pub(crate) first_step: Option<T>,
    pub(crate) min_step: T,
    pub(crate) max_step: T,
    pub(crate) max_steps: u64,
}

/// Fewest stages with coefficients to estimate an error from.
const MIN_STAGES: usize = 2;

impl Method {
    /// An integrator with variable steps whose error, relative to the motion within the step, is about `tolerance` in each step.
    ///
    /// The estimate behind it is the square of an extrapolated Legendre coefficient; `docs/which-steps.md` shows measured errors beside tolerances.
    pub fn tolerance<T: Float>(self, tolerance: T) -> Adaptive<T> {
        let mut base = FixedStep::new(self, T::int(1));
        // A step that fails is shortened, not halved.
        base.max_halvings = 0;
        Adaptive {
            base,
            tolerance,
            scales: [None, None],
            first_step: None,
            min_step: T::int(0),
            max_step: T::INFINITY,
            max_steps: u64::MAX,
        }
    }
}

impl<T: Float> Adaptive<T> {
    /// Motion within a step below these sizes, in the units of positions and momenta, is not resolved relative to itself. By default
    /// √tolerance times the largest position or momentum.
    #[must_use]
    pub fn scales(mut self, positions: T, momenta: T) -> Self {
        self.scales = [Some(positions), Some(momenta)];
        self
    }

    /// Size of the first step; chosen from H by default.
    #[must_use]
    pub fn first_step(mut self, h: T) -> Self {
        self.first_step = Some(h);
        self
    }

    /// Smallest step; a run that needs a smaller one ends with [`IntegrateError::StepBelowMinimum`]. Zero by default: the resolution of time
    /// is the limit. A step cut to reach the end of the run may be smaller.
    #[must_use]
    pub fn min_step(mut self, h: T) -> Self {
        self.min_step = h;
        self
    }

    /// Largest step; no limit by default.
    #[must_use]
    pub fn max_step(mut self, h: T) -> Self {
        self.max_step = h;
        self
    }

    /// Most steps of a run; a run that needs more ends with [`IntegrateError::StepLimit`]. No limit by default.
    #[must_use]
    pub fn max_steps(mut self, steps: u64) -> Self {
        self.max_steps = steps;
        self
    }

    /// See [`FixedStep::reach`]; asked only when shorter steps do not help either.
    #[must_use]
    pub fn reach(mut self, choice: Reach) -> Self {
        self.base = self.base.reach(choice);
        self
    }

    /// See [`FixedStep::alpha_bound`].
    #[must_use]
    pub fn alpha_bound(mut self, bound: T) -> Self {
        self.base = self.base.alpha_bound(bound);
        self
    }

    /// See [`FixedStep::preconditioner`].
    #[must_use]
    pub fn preconditioner(mut self, solver: Preconditioner) -> Self {
        self.base = self.base.preconditioner(solver);
        self
    }

    /// See [`FixedStep::measure_energy`].
    #[must_use]
    pub fn measure_energy(mut self, measure: bool) -> Self {
        self.base = self.base.measure_energy(measure);
        self
    }

    /// See [`FixedStep::invariant`].
    #[must_use]
    pub fn invariant(mut self, invariant: Invariant) -> Self {
        self.base = self.base.invariant(invariant);
        self
    }

    /// See [`FixedStep::keep`].
    #[must_use]
    pub fn keep(mut self, invariant: Invariant) -> Self {
        self.base = self.base.keep(invariant);
        self
    }

    /// Which steps the run keeps in memory; all by default.
    #[must_use]
    pub fn record(mut self, record: Record) -> Self {
        self.base = self.base.record(record);
        self
    }

    /// Times at which the state is wanted besides the steps, ascending and within the interval. They are served from dense output,
    /// with the accuracy of the steps; the steps do not change by a single bit.
    #[must_use]
    pub fn output_at(mut self, times: &[T]) -> Self {
        self.base = self.base.output_at(times);
        self
    }

    /// See [`FixedStep::dense`].
    #[must_use]
    pub fn dense(mut self) -> Self {
        self.base = self.base.dense();
        self
    }

    /// See [`FixedStep::chaos`].
    #[must_use]
    pub fn chaos(mut self) -> Self {
        self.base = self.base.chaos();
        self
    }

    /// See [`FixedStep::event`].
    #[must_use]
    pub fn event(mut self, event: Event<T>) -> Self {
        self.base = self.base.event(event);
        self
    }

    /// Checks everything that does not need the Hamiltonian.
    pub(crate) fn validate(&self) -> Result<StepOptions<T>, IntegrateError<T>> {
        let settings = self.base.validate()?;
        if settings.stages < MIN_STAGES {
            return Err(IntegrateError::StagesOutOfRange {
                stages: settings.stages,
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
        for (scale, name) in self.scales.iter().zip(["scales (q)", "scales (p)"]) {
            let scale = scale.unwrap_or(T::int(1));
            check(finite(scale), name, scale, "positive and finite")?;
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
        Ok(settings)
    }
}
