//! [`StepView`]: an accepted step.

use crate::report::entries::ChaosIndicators;
use equip_scalar::Float;
use equip_solver::Outcome;

/// An accepted step, as observers see it. It borrows; nothing is copied.
#[derive(Debug, Clone, Copy)]
pub struct StepView<'a, T> {
    /// The number of the step, from 1; 0 is the initial state.
    pub index: u64,
    /// The time at the end of the step.
    pub time: T,
    /// The size of the step, negative backward in time.
    pub step: T,
    /// The positions at the end of the step.
    pub q: &'a [T],
    /// The momenta at the end of the step.
    pub p: &'a [T],
    /// H − H_ref at the end of the step; `None` if it was not measured.
    pub energy_error: Option<T>,
    /// The round-off level of the energy error, for steps that solve for the energy.
    pub energy_round_off: Option<T>,
    /// α_1 … α_{s−1} of the step, or of its last part if it was halved.
    pub alphas: &'a [T],
    /// The outcome of the step.
    pub outcome: Outcome,
    /// Lyapunov exponent and MEGNO so far, if the run propagates a tangent vector.
    pub chaos: Option<ChaosIndicators<T>>,
}

/// An accepted step that owns its state, as returned by the iterator.
#[derive(Debug, Clone, PartialEq)]
pub struct Step<T> {
    /// The number of the step, from 1.
    pub index: u64,
    /// The time at the end of the step.
    pub time: T,
    /// The positions at the end of the step.
    pub q: Vec<T>,
    /// The momenta at the end of the step.
    pub p: Vec<T>,
    /// H − H_ref at the end of the step; `None` if it was not measured.
    pub energy_error: Option<T>,
    /// α_1 … α_{s−1} of the step.
    pub alphas: Vec<T>,
    /// The outcome of the step.
    pub outcome: Outcome,
}

impl<T: Float> StepView<'_, T> {
    /// A copy that owns its state.
    pub fn to_step(&self) -> Step<T> {
        Step {
            index: self.index,
            time: self.time,
            q: self.q.to_vec(),
            p: self.p.to_vec(),
            energy_error: self.energy_error,
            alphas: self.alphas.to_vec(),
            outcome: self.outcome,
        }
    }
}
