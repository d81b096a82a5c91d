//! [`StepOptions`]: what a step is to keep, how far its α_k may go, and how its stages are iterated.

use crate::options::family::{Alphas, Family};
use equip_scalar::Float;

/// How far the α_k may move the end point of a step to keep the energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Reach {
    /// Not further than some errors of the step itself. Else the step is made with α = 0, counted, and its
    /// energy error left to a later one.
    #[default]
    WithinError,
    /// As far as the bound of the α_k allows.
    Always,
    /// As `WithinError`, and a step whose energy error would be left ends the integration with an error.
    Refuse,
}

/// M of the iteration Z ← Z + M⁻¹ (K(α) L(Z) − Z) that finds the stages. The solution is the same to
/// round-off with each of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Preconditioner {
    /// The cheapest of the others whose iteration contracts.
    #[default]
    Automatic,
    /// M = 1: fixed-point iteration. Gradients at the stages, no Hessian, no linear system.
    Identity,
    /// Stiff springs along single components of H = T(p) + U(q). Where there are none M = 1, for a Hessian a
    /// step.
    Diagonal,
    /// One ∇²H for all stages (simplified Newton): ⌈s/2⌉ complex systems of size 2m, m where H is separable,
    /// sparse where ∇²H is.
    Frozen,
    /// ∇²H at all stages (Newton): a dense matrix of size s·2m, s·m where T is quadratic.
    Full,
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
    /// How far the α_k may move the end point.
    pub reach: Reach,
    /// Largest |α_k| accepted (dimensionless).
    pub alpha_bound: T,
    /// How often a step whose stages do not converge may be halved.
    pub max_halvings: u32,
    /// How the stages are iterated.
    pub preconditioner: Preconditioner,
    /// Whether a step over which H changes as along no solution is halved. Of a method that does not solve
    /// for H this evaluates H after every step.
    pub check_energy: bool,
}

impl<T: Float> StepOptions<T> {
    /// The member of `family` with so many stages.
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
            reach: Reach::default(),
            alpha_bound: T::ratio(1, 20),
            max_halvings: 10,
            preconditioner: Preconditioner::default(),
            check_energy: false,
        }
    }
}
