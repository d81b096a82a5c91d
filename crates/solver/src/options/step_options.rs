//! [`StepOptions`]: the constraints, the bounds on α_k, and the iteration of the stages.

use crate::options::family::{Alphas, Family};
use equip_scalar::Float;

/// How far the α_k may change the end point of a step to conserve the energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum AlphaPolicy {
    /// At most by a small multiple of the local error. Otherwise the step is accepted with α = 0 and counted
    /// as uncorrected; a later step may remove its energy error.
    #[default]
    WithinError,
    /// As far as the bound of the α_k allows.
    Always,
    /// Like `WithinError`, but an uncorrected step ends the integration with an error.
    Refuse,
}

/// M of the iteration Z ← Z + M⁻¹ (K(α) L(Z) − Z) for the stages. The solution is the same to round-off with
/// each M.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[non_exhaustive]
pub enum Preconditioner {
    /// The least expensive of the others whose iteration contracts.
    #[default]
    Automatic,
    /// M = 1 (fixed-point iteration): gradients at the stages, no Hessian, no linear system.
    Identity,
    /// Stiff harmonic modes along single components of H = T(p) + U(q). If H has no such modes, this is
    /// fixed-point iteration with one additional Hessian a step.
    Diagonal,
    /// One ∇²H for all stages (simplified Newton): ⌈s/2⌉ complex systems of size 2m, or m if H is separable,
    /// sparse if ∇²H is sparse.
    Frozen,
    /// ∇²H at all stages (Newton): a dense matrix of size s·2m, or s·m if T is quadratic with a diagonal
    /// matrix.
    Full,
}

/// The options of a step. The caller has checked the ranges.
#[derive(Debug, Clone)]
pub struct StepOptions<T> {
    /// Number of stages s, 1 to [`MAX_STAGES`](crate::MAX_STAGES).
    pub stages: usize,
    /// The value of α_{s−1} if it is fixed (dimensionless). Requires s ≥ 2.
    pub fixed_alpha: Option<T>,
    /// The index of the first free α_k, from 1; `None` if none is solved for.
    pub first_alpha: Option<usize>,
    /// How far the α_k may change the end point.
    pub alpha_policy: AlphaPolicy,
    /// The largest admissible |α_k| (dimensionless).
    pub alpha_bound: T,
    /// How often a step whose stages do not converge may be halved.
    pub max_halvings: u32,
    /// The preconditioner of the stages.
    pub preconditioner: Preconditioner,
    /// Whether a step is halved if H changes over it more than along a solution (docs/adr/0020). With a
    /// method that does not solve for H, this evaluates H after every step.
    pub check_energy: bool,
}

impl<T: Float> StepOptions<T> {
    /// The options of the member of `family` with this number of stages.
    pub fn new(stages: usize, family: Family) -> Self {
        StepOptions {
            stages,
            fixed_alpha: match family {
                Family::FixedAlpha(alpha) => Some(alpha.to::<T>()),
                _ => None,
            },
            first_alpha: match family {
                Family::Equip(Alphas::Several) => Some(1),
                Family::Equip(Alphas::Last) => Some(stages - 1),
                _ => None,
            },
            alpha_policy: AlphaPolicy::default(),
            alpha_bound: T::ratio(1, 20),
            max_halvings: 10,
            preconditioner: Preconditioner::default(),
            check_energy: false,
        }
    }
}
