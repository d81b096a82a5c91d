//! How a step ended, and the counts of all that was done.

/// How a step ended. Every step has exactly one outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Outcome {
    /// α's were found that bring H back to its reference within the round-off floor.
    Solved,
    /// With α = 0 the energy defect was at the round-off floor already: no α was needed.
    AtFloor,
    /// H is at most quadratic: every member of the family keeps it, nothing to solve.
    Quadratic,
    /// The energy was not asked for (Gauss, fixed α).
    NotAsked,
    /// The step was halved, and H is back at its reference at its end.
    Halved,
    /// No admissible α: the step was made with α = 0 and its defect is left to the next step.
    Carried,
}

impl Outcome {
    /// All outcomes, in the order in which reports name them.
    pub const ALL: [Outcome; 6] = [
        Outcome::Solved,
        Outcome::AtFloor,
        Outcome::Quadratic,
        Outcome::NotAsked,
        Outcome::Halved,
        Outcome::Carried,
    ];

    /// The words used for it in certificates, tables and files.
    pub fn label(self) -> &'static str {
        match self {
            Outcome::Solved => "energy solved",
            Outcome::AtFloor => "at the round-off floor",
            Outcome::Quadratic => "quadratic H, nothing to do",
            Outcome::NotAsked => "energy not asked for",
            Outcome::Halved => "step halved",
            Outcome::Carried => "no admissible α, carried",
        }
    }

    /// Whether H is at its reference at the end of the step, within the round-off floor.
    pub fn energy_kept(self) -> bool {
        matches!(self, Outcome::Solved | Outcome::AtFloor | Outcome::Halved)
    }
}

/// Counts of work and outcomes. Equal runs have equal counts on every machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Counts {
    /// Steps of the grid.
    pub steps: u64,
    /// Newton iterations: stage corrections computed.
    pub newton_iterations: u64,
    /// Sweeps Z ← K L over all stages.
    pub sweeps: u64,
    /// Times that sweeps were tried and the step, or half of it, was left to Newton.
    pub taken_over: u64,
    /// Factorisations of the full Newton matrix, of size s·2m.
    pub factorisations: u64,
    /// Factorisations of the complex systems of simplified Newton, of size 2m, or m for separable H.
    pub simplified_factorisations: u64,
    /// Times the one Hessian of simplified Newton was taken anew; each makes ⌈s/2⌉ of the factorisations above.
    pub refreshes: u64,
    /// Evaluations of ∇H at one point.
    pub gradients: u64,
    /// Evaluations of H alone: to measure an energy that is not solved for, and while α's move along slopes.
    pub energies: u64,
    /// Evaluations of ∇²H at one point.
    pub hessians: u64,
    /// Solves for α: right-hand sides T_k L.
    pub alpha_solves: u64,
    /// Local errors estimated to choose between the α's: each a factorisation for one stage more, not counted above.
    pub local_errors: u64,
    /// Times a step was split into two.
    pub halvings: u64,
    outcomes: [u64; Outcome::ALL.len()],
}

impl Counts {
    /// Steps with the given outcome.
    pub fn outcome(&self, outcome: Outcome) -> u64 {
        self.outcomes[outcome as usize]
    }

    /// Counts a step that ended so.
    pub fn record(&mut self, outcome: Outcome) {
        self.steps += 1;
        self.outcomes[outcome as usize] += 1;
    }
}
