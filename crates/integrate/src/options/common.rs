//! The options common to all step sizes, and their checks.

use crate::error::IntegrateError;
use crate::options::event::Event;
use crate::options::method::Method;
use crate::options::record::Record;
use crate::time::direction::TimeDirection;
use equip_scalar::Float;
use equip_solver::{AlphaPolicy, Family, Invariant, MAX_STAGES, Preconditioner, StepOptions};
use equip_tableau::{Coefficients, TableauError};

/// The options that must agree with a checkpoint: names and values.
pub(crate) type Words = Vec<(&'static str, String)>;

/// A number in decimal digits that are read back to the same number.
pub(crate) fn in_digits<T: Float>(x: T) -> String {
    if T::IS_DOUBLE {
        format!("{x:?}")
    } else {
        x.to_string()
    }
}

/// The coefficients of a method.
pub(crate) fn coefficients<T: Float>(method: Method) -> Result<Coefficients<T>, IntegrateError<T>> {
    let made = method.family.coefficients(method.stages);
    made.map_err(|error| {
        let (stages, min, max) = match error {
            TableauError::StagesOutOfRange { stages, min, max } => (stages, min, max),
            TableauError::TooFewNodes { nodes, degree } => (nodes, degree, MAX_STAGES),
            _ => (method.stages, 1, MAX_STAGES),
        };
        IntegrateError::StagesOutOfRange { stages, min, max }
    })
}

/// An error for the `option` with this `value`, unless it is `ok`.
pub(crate) fn check<T: Float>(
    ok: bool,
    option: &'static str,
    value: T,
    expected: &'static str,
) -> Result<(), IntegrateError<T>> {
    if ok {
        return Ok(());
    }
    Err(IntegrateError::Option {
        option,
        value,
        expected,
    })
}

/// The options that do not concern the size of the steps.
#[derive(Debug, Clone)]
pub(crate) struct Options<T: Float> {
    pub(crate) alpha_policy: AlphaPolicy,
    pub(crate) alpha_bound: T,
    pub(crate) max_halvings: u32,
    pub(crate) preconditioner: Preconditioner,
    pub(crate) measure_energy: bool,
    pub(crate) check_gradient: bool,
    pub(crate) invariants: Vec<Invariant>,
    pub(crate) kept: Vec<Invariant>,
    pub(crate) record: Record,
    pub(crate) output_times: Vec<T>,
    pub(crate) dense: bool,
    pub(crate) events: Vec<Event<T>>,
    pub(crate) chaos: bool,
    /// An option that does not belong to the chosen kind of steps.
    pub(crate) misplaced: Option<&'static str>,
}

impl<T: Float> Default for Options<T> {
    fn default() -> Self {
        let step = StepOptions::new(1, Family::Gauss);
        Options {
            alpha_policy: step.alpha_policy,
            alpha_bound: step.alpha_bound,
            max_halvings: step.max_halvings,
            preconditioner: step.preconditioner,
            measure_energy: true,
            check_gradient: true,
            invariants: Vec::new(),
            kept: Vec::new(),
            record: Record::default(),
            output_times: Vec::new(),
            dense: false,
            events: Vec::new(),
            chaos: false,
            misplaced: None,
        }
    }
}

impl<T: Float> Options<T> {
    /// Checks everything that requires neither the Hamiltonian nor the sizes of the steps.
    pub(crate) fn validate(&self, method: Method) -> Result<StepOptions<T>, IntegrateError<T>> {
        if let Some(option) = self.misplaced {
            return Err(IntegrateError::MisplacedOption { option });
        }
        if let Some(event) = self.events.iter().find(|event| event.action.is_some())
            && self.chaos
        {
            let event = event.name().to_owned();
            return Err(IntegrateError::ChaosWithChange { event });
        }
        let bound = self.alpha_bound;
        check(
            bound > T::int(0) && bound.is_finite(),
            "alpha_bound",
            bound,
            "positive and finite",
        )?;
        let int = |n: u64| T::int(i64::try_from(n).unwrap_or(i64::MAX));
        let halvings = self.max_halvings;
        check(
            halvings <= 20,
            "max_halvings",
            int(halvings.into()),
            "at most 20",
        )?;
        if let Record::Every(k) = self.record {
            check(k > 0, "record", int(k), "Every(k) with k of 1 or more")?;
        }
        if let Family::FixedAlpha(alpha) = method.family {
            let alpha = alpha.to::<T>();
            check(alpha.is_finite(), "fixed_alpha", alpha, "finite")?;
        }
        Ok(StepOptions {
            alpha_policy: self.alpha_policy,
            alpha_bound: bound,
            max_halvings: halvings,
            preconditioner: self.preconditioner,
            ..StepOptions::new(method.stages, method.family)
        })
    }

    /// Method and options as text.
    pub(crate) fn words(&self, method: Method) -> Words {
        let names = |x: &[Invariant]| {
            let names: Vec<_> = x.iter().map(Invariant::name).collect();
            match names.is_empty() {
                true => "none".to_owned(),
                false => names.join(", "),
            }
        };
        let alpha = match method.family {
            Family::FixedAlpha(alpha) => in_digits(alpha.to::<T>()),
            _ => "none".to_owned(),
        };
        vec![
            ("stages", method.stages.to_string()),
            ("method", method.family.to_string()),
            ("fixed α", alpha),
            ("alpha_policy", format!("{:?}", self.alpha_policy)),
            ("alpha_bound", in_digits(self.alpha_bound)),
            ("max_halvings", self.max_halvings.to_string()),
            ("preconditioner", format!("{:?}", self.preconditioner)),
            ("measure_energy", self.measure_energy.to_string()),
            ("invariants preserved", names(&self.kept)),
            ("invariants monitored", names(&self.invariants)),
        ]
    }

    /// Checks the interval, and the output times in it, in the direction of the run.
    pub(crate) fn check_times(&self, start: T, end: T) -> Result<(), IntegrateError<T>> {
        if !start.is_finite() || !end.is_finite() || !(end - start).is_finite() {
            return Err(IntegrateError::Interval { start, end });
        }
        let way = TimeDirection::between(start, end).unwrap_or_default();
        let mut previous = start;
        for (index, &time) in self.output_times.iter().enumerate() {
            let is_out = way.is_before(time, previous) || way.is_before(end, time);
            if is_out || !time.is_finite() {
                return Err(IntegrateError::OutputTime {
                    time,
                    index,
                    start,
                    end,
                });
            }
            previous = time;
        }
        Ok(())
    }
}
