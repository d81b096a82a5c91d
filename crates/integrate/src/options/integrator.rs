//! [`Integrator`]: a method with its steps and options, ready to integrate.

use crate::options::common::{Options, Words};
use crate::options::event::Event;
use crate::options::fixed_step::Fixed;
use crate::options::method::Method;
use crate::options::record::Record;
use crate::options::tolerance::Tolerance;
use equip_scalar::Float;
use equip_solver::{Invariant, Preconditioner, Reach};

/// A method with the sizes of its steps and with options: fixed steps by [`Method::step`], steps by a
/// tolerance by [`Method::tolerance`]. Options are checked when a run starts; one that does not belong to
/// these steps is an [`IntegrateError::MisplacedOption`](crate::IntegrateError::MisplacedOption).
#[derive(Debug, Clone)]
pub struct Integrator<T: Float> {
    pub(crate) method: Method,
    pub(crate) options: Options<T>,
    pub(crate) sizes: StepSizes<T>,
}

/// How steps are sized.
#[derive(Debug, Clone)]
pub(crate) enum StepSizes<T> {
    Fixed(Fixed<T>),
    Tolerance(Tolerance<T>),
}

impl Method {
    /// An integrator with the fixed step `h`, in the float type of `h`. A run over an interval goes its way
    /// with steps of |h|, back in time too, and with h < 0 back only; one that is started and made step by
    /// step goes back in time if h < 0.
    pub fn step<T: Float>(self, h: T) -> Integrator<T> {
        Integrator::new(self, StepSizes::Fixed(Fixed { h }))
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

    /// Method, sizes and options in words: what has to be the same again for a checkpoint to fit.
    pub(crate) fn words(&self) -> Words {
        let mut words = match &self.sizes {
            StepSizes::Fixed(sizes) => sizes.words(),
            StepSizes::Tolerance(sizes) => sizes.words(),
        };
        words.extend(self.options.words(self.method));
        words
    }

    /// How often a fixed step whose stages do not converge may be halved, 10 by default; 0 never halves.
    /// Steps by a tolerance are shortened instead.
    #[must_use]
    pub fn max_halvings(mut self, halvings: u32) -> Self {
        match self.sizes {
            StepSizes::Fixed(_) => self.options.max_halvings = halvings,
            StepSizes::Tolerance(_) => self.options.misplaced = Some("max_halvings"),
        }
        self
    }

    /// How far α_k may move the end point of a step to keep the energy; [`Reach::WithinError`] by default.
    /// With a tolerance it is asked only when shorter steps do not help either.
    #[must_use]
    pub fn reach(mut self, reach: Reach) -> Self {
        self.options.reach = reach;
        self
    }

    /// Largest |α_k| accepted, 0.05 by default (dimensionless; it is added to ξ_k ≈ 1/(4k)). Where a step
    /// needs more, halving it costs less accuracy than a large α does.
    #[must_use]
    pub fn alpha_bound(mut self, bound: T) -> Self {
        self.options.alpha_bound = bound;
        self
    }

    /// How the stages are iterated; [`Preconditioner::Automatic`] by default. The solution is the same.
    #[must_use]
    pub fn preconditioner(mut self, preconditioner: Preconditioner) -> Self {
        self.options.preconditioner = preconditioner;
        self
    }

    /// Whether to evaluate H after steps that do not solve for it (Gauss, fixed α, quadratic H); on by
    /// default. Fixed steps over which H changes as along no motion are halved, if it is evaluated.
    #[must_use]
    pub fn measure_energy(mut self, measure: bool) -> Self {
        self.options.measure_energy = measure;
        self
    }

    /// Whether a gradient written by hand is compared with H: at the start, after steps 1, 2, 4, 8, … and
    /// where a step fails or cannot keep the energy; on by default. A component that differs ends the run
    /// with [`IntegrateError::WrongGradient`](crate::IntegrateError::WrongGradient). Without it steps are
    /// taken as they are, whatever H changes by. Gradients derived from H need no check and cost nothing.
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

    /// A further invariant to be *kept* like the energy, by the same α_k: one more equation for them. For
    /// invariants that are not quadratic; the quadratic ones are kept anyway. Needs a method that solves for
    /// the α_k, with at least as many of them as equations: s − 1 ≥ 1 + the invariants kept. Where H depends
    /// on time it is recorded [with time](equip_autodiff::Hamiltonian::with_time) as well.
    #[must_use]
    pub fn keep(mut self, invariant: Invariant) -> Self {
        self.options.kept.push(invariant);
        self
    }

    /// Which steps the run keeps in memory; all by default.
    #[must_use]
    pub fn record(mut self, record: Record) -> Self {
        self.options.record = record;
        self
    }

    /// Times at which the state is wanted besides the grid, within the interval and in the order in which the
    /// run comes through them. Each costs one
    /// extra step of the same method from the last grid point; the steps of the run do not change by a single
    /// bit.
    #[must_use]
    pub fn output_at(mut self, times: &[T]) -> Self {
        self.options.output_times = times.to_vec();
        self
    }

    /// Keep dense output: [`Run::trajectory`](crate::Run::trajectory) gives the state at any time. The steps
    /// do not change by a single bit; each costs one solve of twice as many stages more.
    #[must_use]
    pub fn dense(mut self) -> Self {
        self.options.dense = true;
        self
    }

    /// An event whose roots along the run are wanted; see [`Run::events`](crate::Run::events). The steps do
    /// not change by a single bit; each costs one solve of twice as many stages more.
    #[must_use]
    pub fn event(mut self, event: Event<T>) -> Self {
        self.options.events.push(event);
        self
    }

    /// Carry a small deviation along: the certificate then has the largest Lyapunov exponent and MEGNO
    /// ([`ChaosIndicators`](crate::ChaosIndicators)), and observers see them grow. The steps do not change by
    /// a single bit; each costs s Hessians and a few linear iterations.
    #[must_use]
    pub fn chaos(mut self) -> Self {
        self.options.chaos = true;
        self
    }
}
