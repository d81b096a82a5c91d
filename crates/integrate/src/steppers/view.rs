//! [`StepView`]: an accepted step.

use crate::report::chaos_indicators::ChaosIndicators;
use equip_scalar::Float;
use equip_solver::Outcome;

/// An accepted step, as observers see it. Borrowed: nothing is copied.
#[derive(Debug, Clone, Copy)]
pub struct StepView<'a, T> {
    /// Number of the step, from 1; 0 is the initial state.
    pub index: u64,
    /// Time at its end.
    pub time: T,
    /// Its size, negative if it went back in time.
    pub step: T,
    /// Positions at its end.
    pub q: &'a [T],
    /// Momenta at its end.
    pub p: &'a [T],
    /// H − H_ref at its end; `None` if it was not measured.
    pub energy_error: Option<T>,
    /// Round-off level of the energy error, for steps that solve for the energy.
    pub energy_round_off: Option<T>,
    /// α_1 … α_{s−1} of the step (of its last part, if it was halved).
    pub alphas: &'a [T],
    /// How it ended.
    pub outcome: Outcome,
    /// Lyapunov exponent and MEGNO so far, if the run follows a deviation.
    pub chaos: Option<ChaosIndicators<T>>,
}

/// An accepted step that owns its state, as the iterator gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct Step<T> {
    /// Number of the step, from 1.
    pub index: u64,
    /// Time at its end.
    pub time: T,
    /// Positions at its end.
    pub q: Vec<T>,
    /// Momenta at its end.
    pub p: Vec<T>,
    /// H − H_ref at its end; `None` if it was not measured.
    pub energy_error: Option<T>,
    /// α_1 … α_{s−1} of the step.
    pub alphas: Vec<T>,
    /// How it ended.
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
