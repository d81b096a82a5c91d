//! [`StepOptions`]: how one step is made.

use crate::family::{Alphas, Family};
use equip_scalar::Float;

/// What to do with a step for which no admissible α exists, after all halvings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OnNoAlpha {
    /// Make the step with α = 0, count it, and let the next step repair the energy.
    #[default]
    Carry,
    /// Refuse the step: it ends with [`Failure::NoAlpha`](crate::Failure::NoAlpha).
    Refuse,
}

/// How the stage equations of a step are solved: the same equations to round-off, with different work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum StageSolver {
    /// Sweeps Z ← K(α) L(Z) as long as they contract; the α's, where they have to move, by the linearised
    /// responses of the step to each of them, found by sweeps as well. No factorisation.
    /// [`Newton`](Self::Newton) for steps where that fails, and for 1, 2, 4, … 64 steps after each one where
    /// sweeps did not contract; for further invariants that are to be kept; for the α of the paper alone.
    ///
    /// From 2m = 24 components on, in `f64` and with s ≥ 4, the α's move by slopes, as with
    /// [`Sweeps`](Self::Sweeps). A step that sweeps do not solve, or whose end point slopes move by more than
    /// 4 estimated local errors (64 where these are next to round-off), is halved as often as
    /// [`StepOptions::max_halvings`] allows before it is Newton's.
    ///
    /// In numbers wider than `f64` the directions of the α's are taken again at the solution until they stay:
    /// a run with reversed momenta comes back to round-off, for two to six times the price of
    /// [`Responses`](Self::Responses).
    #[default]
    Automatic,
    /// As `Automatic`, with directions taken once a step in wide numbers too, and responses for systems of
    /// any size. Trajectories are as good; a run with reversed momenta comes back to the square of the local
    /// error, not to round-off.
    Responses,
    /// Sweeps for everything: gradients at the stages only, no Hessian, no linear system: 1.1 to 1.6 times
    /// the gradients of a Gauss step. The α's move by slopes from Legendre coefficients, not aimed at the
    /// exact flow: energy and quadratic invariants are kept as well, trajectories are 1 to 10 times, in stiff
    /// cases 100 times as far off as those of Gauss with the same step. A step where sweeps do not contract
    /// is halved or fails. Needs s ≥ 4 and the energy as the only constraint; else as `Newton`.
    Sweeps,
    /// Newton as [`FullNewton`](Self::FullNewton) for up to 128 unknowns s·2m (32 where no α is solved for),
    /// as [`SimplifiedNewton`](Self::SimplifiedNewton) beyond. Where that converges badly, full Newton for
    /// some steps, if there are at most 1024 unknowns.
    Newton,
    /// Newton with the Hessians at all stages: factorises matrices of size s·2m, dense. Quadratic
    /// convergence.
    FullNewton,
    /// Newton with one Hessian for all stages, kept over steps while it serves: ⌈s/2⌉ complex systems of size
    /// 2m (m if H is separable), sparse where ∇²H is. Linear convergence, so each iteration of
    /// `max_iterations` counts for four.
    SimplifiedNewton,
}

/// The options of a step. Every value is taken as it is: the caller has checked the ranges.
#[derive(Debug, Clone)]
pub struct StepOptions<T> {
    /// Number of stages s, 1 to [`MAX_STAGES`](crate::MAX_STAGES).
    pub stages: usize,
    /// α_{s−1} where it is fixed (dimensionless), which takes s ≥ 2.
    pub fixed_alpha: Option<T>,
    /// Number of the first free α, from 1; `None` if none is solved for.
    pub first_alpha: Option<usize>,
    /// What to do when no admissible α exists.
    pub on_no_alpha: OnNoAlpha,
    /// Largest |α_k| accepted (dimensionless).
    pub alpha_bound: T,
    /// Newton iterations allowed.
    pub max_iterations: u32,
    /// How often a step that fails may be halved.
    pub max_halvings: u32,
    /// Whether the Newton matrix is factorised anew in every iteration.
    pub pure_newton: bool,
    /// How the stage equations are solved.
    pub stage_solver: StageSolver,
}

impl<T: Float> StepOptions<T> {
    /// The member of `family` with so many stages: α's up to 1/20, 30 iterations, 3 halvings.
    pub fn new(stages: usize, family: Family) -> Self {
        StepOptions {
            stages,
            fixed_alpha: match family {
                Family::FixedAlpha(alpha) => Some(alpha.to::<T>()),
                _ => None,
            },
            first_alpha: match family {
                Family::Equip(Alphas::All) => Some(1),
                Family::Equip(Alphas::Last) => Some(stages - 1),
                _ => None,
            },
            on_no_alpha: OnNoAlpha::default(),
            alpha_bound: T::ratio(1, 20),
            max_iterations: 30,
            max_halvings: 3,
            pure_newton: false,
            stage_solver: StageSolver::default(),
        }
    }
}
