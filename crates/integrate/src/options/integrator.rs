//! [`Integrator`]: a method with its steps and options.

use crate::options::common::{Options, Words, in_digits};
use crate::options::event::Event;
use crate::options::method::Method;
use crate::options::record::Record;
use crate::options::tolerance::Tolerance;
use equip_scalar::Float;
use equip_solver::{AlphaPolicy, Invariant, Preconditioner};

/// A method with step sizes and options. [`Method::step`] gives fixed steps, [`Method::tolerance`] gives
/// steps by a tolerance. Options are checked when a run starts. An option of the other kind of steps is an
/// [`IntegrateError::MisplacedOption`](crate::IntegrateError::MisplacedOption).
#[derive(Debug, Clone)]
pub struct Integrator<T: Float> {
    pub(crate) method: Method,
    pub(crate) options: Options<T>,
    pub(crate) sizes: StepSizes<T>,
}

/// The rule for the step sizes.
#[derive(Debug, Clone)]
pub(crate) enum StepSizes<T> {
    /// Steps of this size. The last one is shorter if the size does not divide the interval.
    Fixed(T),
    Tolerance(Tolerance<T>),
}

impl Method {
    /// An integrator with the fixed step `h`, in the floating-point type of `h`. With h > 0 a run over an
    /// interval has steps of size h in the direction of the interval. With h < 0 the interval must lead
    /// backward in time. A run that is advanced step by step goes backward in time if h < 0.
    pub fn step<T: Float>(self, h: T) -> Integrator<T> {
        Integrator::new(self, StepSizes::Fixed(h))
    }
}

impl<T: Float> Integrator<T> {
    pub(crate) fn new(method: Method, sizes: StepSizes<T>) -> Self {
        Integrator {
            method,
            options: Options::default(),
            sizes,
        }
    }

    /// Method, sizes and options as text, which must agree with a checkpoint.
    pub(crate) fn words(&self) -> Words {
        let mut words = match &self.sizes {
            StepSizes::Fixed(h) => vec![
                ("steps", "of one size".to_owned()),
                ("step", in_digits(h.abs())),
            ],
            StepSizes::Tolerance(sizes) => sizes.words(),
        };
        words.extend(self.options.words(self.method));
        words
    }

    /// How often a fixed step whose stages do not converge may be halved: 10 times by default, 0 never. Step
    /// control shortens steps by a tolerance instead.
    #[must_use]
    pub fn max_halvings(mut self, halvings: u32) -> Self {
        match self.sizes {
            StepSizes::Fixed(_) => self.options.max_halvings = halvings,
            StepSizes::Tolerance(_) => self.options.misplaced = Some("max_halvings"),
        }
        self
    }

    /// How far the α_k may change the end point of a step to conserve the energy. The default is
    /// [`AlphaPolicy::WithinError`].
    #[must_use]
    pub fn alpha_policy(mut self, alpha_policy: AlphaPolicy) -> Self {
        self.options.alpha_policy = alpha_policy;
        self
    }

    /// The largest admissible |α_k|, 0.05 by default (dimensionless; α_k is added to ξ_k ≈ 1/(4k)). If a step
    /// needs a larger α, reduce the step size instead of raising this bound: a large α costs more accuracy.
    #[must_use]
    pub fn alpha_bound(mut self, bound: T) -> Self {
        self.options.alpha_bound = bound;
        self
    }

    /// The preconditioner of the stages; [`Preconditioner::Automatic`] by default. The solution is the same
    /// with each.
    #[must_use]
    pub fn preconditioner(mut self, preconditioner: Preconditioner) -> Self {
        self.options.preconditioner = preconditioner;
        self
    }

    /// Whether to evaluate H after steps that do not solve for it (Gauss, fixed α, quadratic H); on by
    /// default. If H is evaluated, a fixed step is halved if H changes over it more than along a solution.
    #[must_use]
    pub fn measure_energy(mut self, measure: bool) -> Self {
        self.options.measure_energy = measure;
        self
    }

    /// Whether a user-supplied gradient is compared with H: at the start, after steps 1, 2, 4, 8, …, and
    /// where a step fails or is uncorrected. On by default. A component that differs ends the run with
    /// [`IntegrateError::WrongGradient`](crate::IntegrateError::WrongGradient). Without this check steps are
    /// accepted for any change of H. Gradients that are derived from H need no check, and cost nothing.
    #[must_use]
    pub fn check_gradient(mut self, check: bool) -> Self {
        self.options.check_gradient = check;
        self
    }

    /// A further quantity whose error the certificate shows.
    #[must_use]
    pub fn invariant(mut self, invariant: Invariant) -> Self {
        self.options.invariants.push(invariant);
        self
    }

    /// A further invariant to be *conserved* like the energy, by the same α_k: one more equation for the α_k.
    /// Quadratic invariants are conserved anyway, and are only measured. The others must be independent of
    /// each other, of H and of the quadratic invariants: no α conserves two that depend on each other.
    /// Requires a method that solves for the α_k, with at least as many parameters as equations: s − 1 ≥ 1 +
    /// the number of such invariants. If H depends on time, the invariant must be traced [with
    /// time](equip_autodiff::Hamiltonian::with_time) as well.
    #[must_use]
    pub fn preserve(mut self, invariant: Invariant) -> Self {
        self.options.kept.push(invariant);
        self
    }

    /// Which steps the run stores; all by default.
    #[must_use]
    pub fn record(mut self, record: Record) -> Self {
        self.options.record = record;
        self
    }

    /// Additional times at which the state is computed, within the interval and in the direction of the run.
    /// With fixed steps each costs one extra step of the same method from the last grid point. The steps of
    /// the run do not change by a single bit.
    #[must_use]
    pub fn output_at(mut self, times: &[T]) -> Self {
        self.options.output_times = times.to_vec();
        self
    }

    /// Stores dense output: [`Run::trajectory`](crate::Run::trajectory) gives the state at any time. The
    /// steps do not change by a single bit. Each step costs one additional solve with twice as many stages.
    #[must_use]
    pub fn dense(mut self) -> Self {
        self.options.dense = true;
        self
    }

    /// An event whose roots along the run are found; see [`Run::events`](crate::Run::events). The steps do
    /// not change by a single bit. Each step costs one additional solve with twice as many stages.
    #[must_use]
    pub fn event(mut self, event: Event<T>) -> Self {
        self.options.events.push(event);
        self
    }

    /// Propagates a tangent vector. The certificate then has the largest Lyapunov exponent and MEGNO
    /// ([`ChaosIndicators`](crate::ChaosIndicators)), and observers see their development. The steps do not
    /// change by a single bit. Each step costs s Hessians and a few linear iterations in addition. Events
    /// that change the state are rejected, since the derivative of the change is not known.
    #[must_use]
    pub fn chaos(mut self) -> Self {
        self.options.chaos = true;
        self
    }
}
