//! A case: all that a seed decides, and its run.

use equip_integrate::{
    AlphaPolicy, Alphas, Counts, Equip, IntegrateError, Integrator, Outcome, RunFailure, StepView,
};
use equip_tests::{RandomSystem, Seeded, rate};
use std::ops::ControlFlow;

/// Everything that a seed decides.
pub(super) struct Case {
    pub(super) seed: u64,
    pub(super) system: RandomSystem,
    pub(super) stages: usize,
    pub(super) alphas: Alphas,
    pub(super) alpha_policy: AlphaPolicy,
    pub(super) max_halvings: u32,
    /// Step times the fastest rate at the start.
    pub(super) h_omega: f64,
    pub(super) h: f64,
    pub(super) steps: usize,
}

impl std::fmt::Display for Case {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let RandomSystem {
            kind, separable, m, ..
        } = self.system;
        let Case {
            seed,
            stages,
            alphas,
            h_omega,
            h,
            steps,
            max_halvings,
            ..
        } = self;
        write!(
            f,
            "seed {seed}: {kind:?}, separable {separable}, m = {m}, s = {stages}, {alphas:?}, {steps} steps, h = {h:.3e}, hω = {h_omega:.1e}, halvings {max_halvings}, {:?}",
            self.alpha_policy
        )
    }
}

impl Case {
    pub(super) fn new(seed: u64) -> Self {
        let rng = &mut Seeded::new(seed);
        let system = RandomSystem::draw(rng);
        let h_omega = rng.power_of_ten(-4.0, 2.0);
        let rate = match rate(&system.hamiltonian, &system.start) {
            rate if rate > 0.0 && rate.is_finite() => rate,
            _ => 1.0,
        };
        Case {
            seed,
            stages: 2 + rng.below(11),
            alphas: if rng.once_in(6) {
                Alphas::Last
            } else {
                Alphas::Several
            },
            alpha_policy: if rng.once_in(6) {
                AlphaPolicy::Refuse
            } else {
                AlphaPolicy::WithinError
            },
            max_halvings: [3, 3, 3, 0, 1, 2][rng.below(6)],
            h_omega,
            h: h_omega / rate,
            steps: 8 + rng.below(5),
            system,
        }
    }

    pub(super) fn options(&self) -> Integrator<f64> {
        Equip::stages(self.stages)
            .alphas(self.alphas)
            .step(self.h)
            .alpha_policy(self.alpha_policy)
            .max_halvings(self.max_halvings)
    }
}

/// A step as it was seen.
#[derive(Debug)]
pub(super) struct Seen {
    pub(super) y: Vec<f64>,
    pub(super) outcome: Outcome,
    pub(super) defect: f64,
    pub(super) floor: Option<f64>,
    pub(super) alphas: Vec<f64>,
}

/// A run of a case to its end, or to a typed error.
#[derive(Debug)]
pub(super) struct Ran {
    pub(super) seen: Vec<Seen>,
    pub(super) counts: Counts,
    pub(super) error: Option<IntegrateError<f64>>,
}

pub(super) fn run(case: &Case) -> Ran {
    let mut seen = Vec::new();
    let mut watch = |view: &StepView<'_, f64>| {
        seen.push(Seen {
            y: [view.q, view.p].concat(),
            outcome: view.outcome,
            defect: view.energy_error.unwrap(),
            floor: view.energy_round_off,
            alphas: view.alphas.to_vec(),
        });
        ControlFlow::Continue(())
    };
    let (q, p) = case.system.start.split_at(case.system.m);
    let end = case.h * case.steps as f64;
    let result =
        case.options()
            .integrate_observed(&case.system.hamiltonian, q, p, 0.0..=end, &mut watch);
    let (run, error) = match result {
        Ok(run) => (run, None),
        Err(RunFailure { error, partial }) => {
            (*partial.unwrap_or_else(|| panic!("{error:?}")), Some(error))
        }
    };
    // What the run kept is what was seen, and a failed run has all of it.
    assert_eq!(run.len(), seen.len() + 1);
    for (i, seen) in seen.iter().enumerate() {
        assert_eq!([run.q(i + 1), run.p(i + 1)].concat(), seen.y);
        assert_eq!(run.outcomes()[i + 1], seen.outcome);
    }
    if error.is_none() {
        assert_eq!(seen.len(), case.steps);
    }
    let counts = run.certificate().counts;
    Ran {
        seen,
        counts,
        error,
    }
}
