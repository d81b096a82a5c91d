//! [`FixedStep`]: a method with its step and options, ready to integrate.

use crate::error::IntegrateError;
use crate::event::Event;
use crate::invariant::Invariant;
use crate::method::{Alphas, Family, Method};
use crate::{MAX_STAGES, MIN_EQUIP_STAGES};
use equip_scalar::Float;

/// What to do with a step for which no admissible α exists, after all halvings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OnNoAlpha {
    /// Make the step with α = 0, count it, and let the next step repair the energy.
    #[default]
    Carry,
    /// End the integration with [`IntegrateError::NoAdmissibleAlpha`].
    Refuse,
}

/// Which steps of the grid a [`Run`](crate::Run) keeps. The first and the last state are always kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Record {
    /// Every step.
    #[default]
    All,
    /// Every k-th step, k ≥ 1.
    Every(u64),
    /// The first and the last state only.
    Ends,
}

impl Record {
    /// Whether step number `index` is kept.
    pub(crate) fn keeps(self, index: u64) -> bool {
        match self {
            Record::All => true,
            Record::Every(k) => index.is_multiple_of(k),
            Record::Ends => false,
        }
    }
}

/// How the stage equations of a step are solved: the same equations to round-off, with different work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum StageSolver {
    /// Sweeps Z ← K(α) L(Z) as long as they contract; the α's, where they have to move, by the linearised responses of the step to each of them, found
    /// by sweeps as well. No factorisation. [`Newton`](Self::Newton) for steps where that fails, and for 1, 2, 4, … 64 steps after each one
    /// where sweeps did not contract; for further invariants that are to be kept; for the α of the paper alone.
    ///
    /// From 2m = 24 components on, in `f64` and with s ≥ 4, the α's move by slopes, as with [`Sweeps`](Self::Sweeps). A step that sweeps do not solve, or
    /// whose end point slopes move by more than 4 estimated local errors (64 where these are next to round-off), is halved as often as
    /// [`FixedStep::max_halvings`] allows before it is Newton's.
    ///
    /// In numbers wider than `f64` the directions of the α's are taken again at the solution until they stay: a run with reversed momenta comes back to
    /// round-off, for two to six times the price of [`Responses`](Self::Responses).
    #[default]
    Automatic,
    /// As `Automatic`, with directions taken once a step in wide numbers too, and responses for systems of any size. Trajectories are as good; a run with
    /// reversed momenta comes back to the square of the local error, not to round-off.
    Responses,
    /// Sweeps for everything: gradients at the stages only, no Hessian, no linear system: 1.1 to 1.6 times the gradients of a Gauss step. The
    /// α's move by slopes from Legendre coefficients, not aimed at the exact flow: energy and quadratic
    /// invariants are kept as well, trajectories are 1 to 10 times, in stiff cases 100 times as far off as those of Gauss with the same
    /// step. A step where sweeps do not contract is halved or fails. Needs s ≥ 4 and the energy as the only constraint;
    /// else as `Newton`.
    Sweeps,
    /// Newton as [`FullNewton`](Self::FullNewton) for up to 128 unknowns s·2m (32 where no α is solved for), as
    /// [`SimplifiedNewton`](Self::SimplifiedNewton) beyond. Where that converges badly, full Newton for some steps, if there are at most 1024 unknowns.
    Newton,
    /// Newton with the Hessians at all stages: factorises matrices of size s·2m, dense. Quadratic convergence.
    FullNewton,
    /// Newton with one Hessian for all stages, kept over steps while it serves: ⌈s/2⌉ complex systems of size 2m (m if H is
    /// separable), sparse where ∇²H is. Linear convergence, so each iteration of `max_iterations` counts for four.
    SimplifiedNewton,
}

/// A method with a fixed step: fixed for the whole run, the last step shorter if it does not divide the interval.
#[derive(Debug, Clone)]
pub struct FixedStep<T: Float> {
    pub(crate) method: Method,
    pub(crate) h: T,
    pub(crate) on_no_alpha: OnNoAlpha,
    pub(crate) alpha_bound: T,
    pub(crate) max_iterations: u32,
    pub(crate) max_halvings: u32,
    pub(crate) pure_newton: bool,
    pub(crate) stage_solver: StageSolver,
    pub(crate) measure_energy: bool,
    pub(crate) invariants: Vec<Invariant>,
    pub(crate) kept: Vec<Invariant>,
    pub(crate) record: Record,
    pub(crate) output_times: Vec<T>,
    pub(crate) dense: bool,
    pub(crate) events: Vec<Event<T>>,
    pub(crate) chaos: bool,
}

/// Options after validation, in the form the step wants them.
#[derive(Debug, Clone)]
pub(crate) struct Settings<T> {
    pub(crate) stages: usize,
    pub(crate) fixed_alpha: Option<T>,
    /// Number of the first free α; `None` if none is solved for.
    pub(crate) first_alpha: Option<usize>,
    pub(crate) on_no_alpha: OnNoAlpha,
    pub(crate) alpha_bound: T,
    pub(crate) max_iterations: u32,
    pub(crate) max_halvings: u32,
    pub(crate) pure_newton: bool,
    pub(crate) stage_solver: StageSolver,
}

impl<T: Float> Settings<T> {
    /// The Gauss method without halvings.
    pub(crate) fn plain(stages: usize, max_iterations: u32, stage_solver: StageSolver) -> Self {
        Settings {
            stages,
            fixed_alpha: None,
            first_alpha: None,
            on_no_alpha: OnNoAlpha::Carry,
            alpha_bound: T::int(1),
            max_iterations,
            max_halvings: 0,
            pure_newton: false,
            stage_solver,
        }
    }
}

impl<T: Float> FixedStep<T> {
    pub(crate) fn new(method: Method, h: T) -> Self {
        FixedStep {
            method,
            h,
            on_no_alpha: OnNoAlpha::default(),
            alpha_bound: T::ratio(1, 20),
            max_iterations: 30,
            max_halvings: 3,
            pure_newton: false,
            stage_solver: StageSolver::default(),
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

    /// What to do when no α keeps the energy; [`OnNoAlpha::Carry`] by default.
    #[must_use]
    pub fn on_no_alpha(mut self, choice: OnNoAlpha) -> Self {
        self.on_no_alpha = choice;
        self
    }

    /// Largest |α_k| accepted, 0.05 by default (dimensionless; it is added to ξ_k ≈ 1/(4k)). Where a step needs more, halving it
    /// costs less accuracy than a large α does.
    #[must_use]
    pub fn alpha_bound(mut self, bound: T) -> Self {
        self.alpha_bound = bound;
        self
    }

    /// Newton iterations allowed per step, 30 by default.
    #[must_use]
    pub fn max_iterations(mut self, iterations: u32) -> Self {
        self.max_iterations = iterations;
        self
    }

    /// How often a step that fails may be halved, 3 by default; 0 never halves. With [`StageSolver::Sweeps`], and from 24 components on by default, a step
    /// that sweeps do not solve is one that fails.
    #[must_use]
    pub fn max_halvings(mut self, halvings: u32) -> Self {
        self.max_halvings = halvings;
        self
    }

    /// Factor the Newton matrix in every iteration, also where the last factorisation would serve. For studies.
    #[must_use]
    pub fn pure_newton(mut self, pure: bool) -> Self {
        self.pure_newton = pure;
        self
    }

    /// How the stage equations are solved; [`StageSolver::Automatic`] by default.
    #[must_use]
    pub fn stage_solver(mut self, solver: StageSolver) -> Self {
        self.stage_solver = solver;
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
    pub(crate) fn validate(&self) -> Result<Settings<T>, IntegrateError<T>> {
        let s = self.method.stages;
        let min = match self.method.family {
            Family::Gauss => 1,
            Family::FixedAlpha(_) | Family::Equip(_) => MIN_EQUIP_STAGES,
        };
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
        let iterations = self.max_iterations;
        check(
            iterations >= 2,
            "max_iterations",
            int(iterations.into()),
            "2 or more",
        )?;
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
        let fixed_alpha = match self.method.family {
            Family::FixedAlpha(alpha) => Some(alpha.to::<T>()),
            _ => None,
        };
        if let Some(alpha) = fixed_alpha {
            check(alpha.is_finite(), "fixed_alpha", alpha, "finite")?;
        }
        Ok(Settings {
            stages: s,
            fixed_alpha,
            first_alpha: match self.method.family {
                Family::Equip(Alphas::All) => Some(1),
                Family::Equip(Alphas::Last) => Some(s - 1),
                _ => None,
            },
            on_no_alpha: self.on_no_alpha,
            alpha_bound: bound,
            max_iterations: iterations,
            max_halvings: halvings,
            pure_newton: self.pure_newton,
            stage_solver: self.stage_solver,
        })
    }
}
