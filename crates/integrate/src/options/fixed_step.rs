//! [`FixedStep`]: a method with its step and options, ready to integrate.

use crate::error::IntegrateError;
use crate::method::Method;
use crate::options::event::Event;
use crate::options::record::Record;
use equip_scalar::Float;
use equip_solver::{Family, Invariant, MAX_STAGES, Reach, Preconditioner, StepOptions};

/// A method with a fixed step: fixed for the whole run, the last step shorter if it does not divide the interval.
#[derive(Debug, Clone)]
pub struct FixedStep<T: Float> {
    pub(crate) method: Method,
    pub(crate) h: T,
    pub(crate) reach: Reach,
    pub(crate) alpha_bound: T,
    pub(crate) max_halvings: u32,
    pub(crate) preconditioner: Preconditioner,
    pub(crate) measure_energy: bool,
    pub(crate) invariants: Vec<Invariant>,
    pub(crate) kept: Vec<Invariant>,
    pub(crate) record: Record,
    pub(crate) output_times: Vec<T>,
    pub(crate) dense: bool,
    pub(crate) events: Vec<Event<T>>,
    pub(crate) chaos: bool,
}

impl Method {
    /// An integrator with the fixed step `h`, in the float type of `h`.
    pub fn step<T: Float>(self, h: T) -> FixedStep<T> {
        FixedStep::new(self, h)
    }
}

impl<T: Float> FixedStep<T> {
    pub(crate) fn new(method: Method, h: T) -> Self {
        FixedStep {
            method,
            h,
            reach: Reach::default(),
            alpha_bound: T::ratio(1, 20),
            max_halvings: 3,
            preconditioner: Preconditioner::default(),
            measure_energy: true,
            invariants: Vec::new(),
            kept: Vec::new(),
            record: Record::default(),
            output_times: Vec::new(),
            dense: false,
            events: Vec::new(),
            chaos: false,
        }
    }

    /// How far α's may move the end point of a step to keep the energy; [`Reach::WithinError`] by default.
    #[must_use]
    pub fn reach(mut self, reach: Reach) -> Self {
        self.reach = reach;
        self
    }

    /// Largest |α_k| accepted, 0.05 by default (dimensionless; it is added to ξ_k ≈ 1/(4k)). Where a step needs more, halving it
    /// costs less accuracy than a large α does.
    #[must_use]
    pub fn alpha_bound(mut self, bound: T) -> Self {
        self.alpha_bound = bound;
        self
    }

    /// How often a step whose stages do not converge may be halved, 3 by default; 0 never halves.
    #[must_use]
    pub fn max_halvings(mut self, halvings: u32) -> Self {
        self.max_halvings = halvings;
        self
    }

    /// How the stages are iterated; [`Preconditioner::Automatic`] by default. The solution is the same.
    #[must_use]
    pub fn preconditioner(mut self, preconditioner: Preconditioner) -> Self {
        self.preconditioner = preconditioner;
        self
    }

    /// Whether to evaluate H after steps that do not solve for it (Gauss, fixed α, quadratic H); on by default.
    #[must_use]
    pub fn measure_energy(mut self, measure: bool) -> Self {
        self.measure_energy = measure;
        self
    }

    /// A further quantity whose defect the certificate shows.
    #[must_use]
    pub fn invariant(mut self, invariant: Invariant) -> Self {
        self.invariants.push(invariant);
        self
    }

    /// A further invariant to be *kept* like the energy, by the same α's: one more equation for them. For invariants that
    /// are not quadratic; the quadratic ones are kept anyway. Needs a method that solves for the α's, with at least as
    /// many of them as equations: s − 1 ≥ 1 + the invariants kept.
    #[must_use]
    pub fn keep(mut self, invariant: Invariant) -> Self {
        self.kept.push(invariant);
        self
    }

    /// Which steps the run keeps in memory; all by default.
    #[must_use]
    pub fn record(mut self, record: Record) -> Self {
        self.record = record;
        self
    }

    /// Times at which the state is wanted besides the grid, ascending and within the interval. Each costs one extra
    /// step of the same method from the last grid point; the steps of the run do not change by a single bit.
    #[must_use]
    pub fn output_at(mut self, times: &[T]) -> Self {
        self.output_times = times.to_vec();
        self
    }

    /// Keep dense output: [`Run::trajectory`](crate::Run::trajectory) gives the state at any time. The steps do not change by a single bit;
    /// each costs one solve of twice as many stages more.
    #[must_use]
    pub fn dense(mut self) -> Self {
        self.dense = true;
        self
    }

    /// An event whose roots along the run are wanted; see [`Run::events`](crate::Run::events). The steps do not change by a single bit; each
    /// costs one solve of twice as many stages more.
    #[must_use]
    pub fn event(mut self, event: Event<T>) -> Self {
        self.events.push(event);
        self
    }

    /// Carry a small deviation along: the certificate then has the largest Lyapunov exponent and MEGNO
    /// ([`ChaosIndicators`](crate::ChaosIndicators)), and observers see them grow. The steps do not change by a single bit; each costs s Hessians and a few
    /// sweeps more.
    #[must_use]
    pub fn chaos(mut self) -> Self {
        self.chaos = true;
        self
    }

    /// Checks everything that does not need the Hamiltonian.
    pub(crate) fn validate(&self) -> Result<StepOptions<T>, IntegrateError<T>> {
        let s = self.method.stages;
        let min = self.method.family.fewest_stages();
        if !(min..=MAX_STAGES).contains(&s) {
            return Err(IntegrateError::StagesOutOfRange {
                stages: s,
                min,
                max: MAX_STAGES,
            });
        }
        if !(self.h > T::int(0)) || !self.h.is_finite() {
            return Err(IntegrateError::StepNotPositive { step: self.h });
        }
        let check = |ok: bool, option, value, expected| {
            if ok {
                Ok(())
            } else {
                Err(IntegrateError::Option {
                    option,
                    value,
                    expected,
                })
            }
        };
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
        if let Family::FixedAlpha(alpha) = self.method.family {
            let alpha = alpha.to::<T>();
            check(alpha.is_finite(), "fixed_alpha", alpha, "finite")?;
        }
        Ok(StepOptions {
            reach: self.reach,
            alpha_bound: bound,
            max_halvings: halvings,
            preconditioner: self.preconditioner,
            ..StepOptions::new(s, self.method.family)
        })
    }
}
