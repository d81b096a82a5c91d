//! How a step ended, and the counts of work and outcomes.

use equip_autodiff::Evaluator;
use equip_scalar::Float;
use std::fmt;

/// How a step ended. Every step has exactly one outcome; a halved step has the outcome of its worse half.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Outcome {
    /// The energy was not requested as a constraint (Gauss, fixed α).
    NotRequested,
    /// H is at most quadratic: every method of the family conserves it.
    Quadratic,
    /// With α = 0 the energy error was already at the round-off level.
    AtRoundOff,
    /// An admissible α was found for which the energy error is at the round-off level.
    Solved,
    /// Uncorrected: no α changes the energy. The step was accepted with α = 0, and a later step may remove
    /// its energy error. This holds for the next three cases as well. Also a step that an event ends at a
    /// state on its polynomial, since no step ends there.
    NoEffect,
    /// Uncorrected: the energy would require an α beyond its bound, or an α for which the stages do not
    /// converge.
    BeyondBound,
    /// Uncorrected: α would change the end point by more than the bound, a multiple of the local error.
    TooFar,
    /// Uncorrected: the step does not resolve its fastest motion. Its energy error belongs to that motion,
    /// and α would correct the slow motion instead.
    Unresolved,
}

impl Outcome {
    /// All outcomes, in the order in which reports name them.
    pub const ALL: [Outcome; 8] = [
        Outcome::NotRequested,
        Outcome::Quadratic,
        Outcome::AtRoundOff,
        Outcome::Solved,
        Outcome::NoEffect,
        Outcome::BeyondBound,
        Outcome::TooFar,
        Outcome::Unresolved,
    ];

    /// The words for the outcome in certificates, tables and files.
    pub fn label(self) -> &'static str {
        match self {
            Outcome::NotRequested => "energy not requested",
            Outcome::Quadratic => "quadratic H, nothing to do",
            Outcome::AtRoundOff => "at the round-off level",
            Outcome::Solved => "energy solved",
            Outcome::NoEffect => "uncorrected: no effect of α",
            Outcome::BeyondBound => "uncorrected: α beyond its bound",
            Outcome::TooFar => "uncorrected: end point changed too much",
            Outcome::Unresolved => "uncorrected: fast motion not resolved",
        }
    }

    /// Whether the energy error at the end of the step is at the round-off level.
    pub fn energy_conserved(self) -> bool {
        matches!(
            self,
            Outcome::Solved | Outcome::AtRoundOff | Outcome::Quadratic
        )
    }

    /// Whether the step is uncorrected: its energy error was not removed.
    pub fn is_uncorrected(self) -> bool {
        matches!(
            self,
            Outcome::NoEffect | Outcome::BeyondBound | Outcome::TooFar | Outcome::Unresolved
        )
    }
}

/// Counts of work and outcomes. The counts of equal runs are equal on every machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Counts {
    /// Completed steps.
    pub steps: u64,
    /// Fixed-point iterations Z ← K L over all stages.
    pub fixed_point_iterations: u64,
    /// Preconditioned iterations.
    pub newton_iterations: u64,
    /// Restarts of the stages of a step with another or a recomputed preconditioner.
    pub preconditioner_changes: u64,
    /// Factorisations with ∇²H at all stages: a dense matrix of size s·2m, or s·m for H = T(p) + U(q).
    pub factorisations: u64,
    /// Complex systems factorised for one ∇²H: ⌈s/2⌉ for each preconditioner, of size 2m, or m for separable
    /// H.
    pub simplified_factorisations: u64,
    /// Evaluations of ∇H at one point, including those of differences for ∇²H.
    pub gradients: u64,
    /// Evaluations of H alone, to measure an energy that is not a constraint.
    pub energies: u64,
    /// Evaluations of ∇²H at one point.
    pub hessians: u64,
    /// Search directions of α: one for each step that solves for α.
    pub directions: u64,
    /// Updates of α.
    pub alpha_updates: u64,
    /// Local errors estimated to decide whether a change of y1 is admissible. The s + 2 gradients of each are
    /// counted above.
    pub local_errors: u64,
    /// How often a step was split into two halves.
    pub halvings: u64,
    outcomes: ByOutcome,
}

/// The number of steps by outcome. Printed and serialised by name, without zeros.
#[derive(Clone, Copy, PartialEq, Eq, Default, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        into = "std::collections::BTreeMap<Outcome, u64>",
        from = "std::collections::BTreeMap<Outcome, u64>"
    )
)]
struct ByOutcome([u64; Outcome::ALL.len()]);

impl ByOutcome {
    fn named(&self) -> impl Iterator<Item = (Outcome, u64)> {
        let counts = Outcome::ALL.into_iter().zip(self.0);
        counts.filter(|&(_, count)| count > 0)
    }
}

impl fmt::Debug for ByOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.named()).finish()
    }
}

#[cfg(feature = "serde")]
impl From<ByOutcome> for std::collections::BTreeMap<Outcome, u64> {
    fn from(counts: ByOutcome) -> Self {
        counts.named().collect()
    }
}

#[cfg(feature = "serde")]
impl From<std::collections::BTreeMap<Outcome, u64>> for ByOutcome {
    fn from(named: std::collections::BTreeMap<Outcome, u64>) -> Self {
        let mut counts = ByOutcome::default();
        for (outcome, count) in named {
            counts.0[outcome as usize] = count;
        }
        counts
    }
}

impl Counts {
    /// Steps with the given outcome.
    pub fn outcome(&self, outcome: Outcome) -> u64 {
        self.outcomes.0[outcome as usize]
    }

    /// Adds ∇²H at this number of points, and the gradients of which it is computed.
    pub(crate) fn add_hessians<T: Float>(&mut self, points: usize, energy: &Evaluator<T>) {
        let points = points as u64;
        self.hessians += points;
        self.gradients += points * energy.gradients_of_hessian();
    }

    /// The number of uncorrected steps.
    pub fn uncorrected(&self) -> u64 {
        let uncorrected = Outcome::ALL.into_iter().filter(|o| o.is_uncorrected());
        uncorrected.map(|o| self.outcome(o)).sum()
    }

    /// Counts a step with this outcome.
    pub fn record(&mut self, outcome: Outcome) {
        self.steps += 1;
        self.outcomes.0[outcome as usize] += 1;
    }

    /// The last step recorded is repeated, with another outcome.
    pub fn replace(&mut self, last: Outcome, outcome: Outcome) {
        self.outcomes.0[last as usize] -= 1;
        self.outcomes.0[outcome as usize] += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::{Counts, Outcome};

    #[test]
    fn counts_print_outcomes_by_name() {
        let mut counts = Counts::default();
        for outcome in [Outcome::Solved, Outcome::AtRoundOff, Outcome::Solved] {
            counts.record(outcome);
        }
        let text = format!("{counts:?}");
        assert!(
            text.ends_with("outcomes: {AtRoundOff: 1, Solved: 2} }"),
            "{text}"
        );
    }

    /// The classification of the certificate.
    #[test]
    fn outcomes_are_kept_carried_or_not_asked() {
        for outcome in Outcome::ALL {
            let is = [
                outcome.energy_conserved(),
                outcome.is_uncorrected(),
                outcome == Outcome::NotRequested,
            ];
            assert_eq!(is.iter().filter(|&&is| is).count(), 1, "{outcome:?}");
        }
        assert!(Outcome::Quadratic.energy_conserved());
    }
}
