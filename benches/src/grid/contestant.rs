//! EQUIP as it comes and Gauss on the same steps: the only file of this program that uses the solver.

use cpu_time::ThreadTime;
use equip_autodiff::Hamiltonian;
use equip_integrate::{Equip, Gauss, Outcome};
use std::time::Duration;

/// Who makes the steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Contestant {
    Equip,
    Gauss,
}

/// `steps` steps of size `step` from (q, p), with `stages` stages.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task<'a> {
    pub(crate) hamiltonian: &'a Hamiltonian,
    pub(crate) q: &'a [f64],
    pub(crate) p: &'a [f64],
    pub(crate) stages: usize,
    pub(crate) step: f64,
    pub(crate) steps: u64,
}

/// Counts of work of a run.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Work {
    pub(crate) gradients: u64,
    pub(crate) hessians: u64,
    pub(crate) fixed_point_iterations: u64,
    pub(crate) newton_iterations: u64,
    pub(crate) factorisations: u64,
}

/// How a run came to its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Ending {
    /// All steps were made.
    Done,
    /// The limit of time was reached first.
    Cut,
    /// An error, with its text.
    Failed(String),
}

/// What a run showed.
#[derive(Debug, Clone)]
pub(crate) struct Leg {
    pub(crate) ending: Ending,
    /// CPU time of the steps in seconds, without the set-up; of all steps, at the same pace, if it was cut.
    pub(crate) seconds: f64,
    /// The last state (q, p).
    pub(crate) state: Vec<f64>,
    pub(crate) work: Work,
    /// Steps by the name of their outcome.
    pub(crate) outcomes: Vec<(String, u64)>,
    /// Steps made.
    pub(crate) steps: u64,
    /// Steps with the energy at its round-off level, as their outcome says.
    pub(crate) kept: u64,
    /// Largest |H − H_ref|.
    pub(crate) energy: f64,
    /// Largest floor of the energy that the solver reported.
    pub(crate) floor: f64,
}

/// Steps between two readings of the clock, as long as they are quick.
const CLOCK: u64 = 4;

/// Makes the steps, as long as they take less than `limit` of CPU time.
pub(crate) fn run(contestant: Contestant, task: &Task<'_>, limit: Duration) -> Leg {
    let method = match contestant {
        Contestant::Equip => Equip::stages(task.stages),
        Contestant::Gauss => Gauss::stages(task.stages),
    };
    let started = method
        .step(task.step)
        .start(task.hamiltonian, task.q, task.p, 0.0);
    let mut stepper = match started {
        Ok(stepper) => stepper,
        Err(error) => return Leg::without_steps(error.to_string(), task),
    };
    let (mut energy, mut floor) = (0.0_f64, 0.0_f64);
    let mut ending = Ending::Done;
    let mut is_slow = false;
    let begun = ThreadTime::now();
    for index in 0..task.steps {
        match stepper.advance() {
            Ok(view) => {
                energy = energy.max(view.energy_error.map_or(0.0, f64::abs));
                floor = floor.max(view.energy_round_off.unwrap_or(0.0));
            }
            Err(error) => {
                ending = Ending::Failed(error.to_string());
                break;
            }
        }
        if (index % CLOCK == 0 || is_slow) && index + 1 < task.steps {
            let elapsed = begun.elapsed();
            is_slow = elapsed > limit / 16;
            if elapsed > limit {
                ending = Ending::Cut;
                break;
            }
        }
    }
    let seconds = begun.elapsed().as_secs_f64();
    let view = stepper.view();
    let state = [view.q, view.p].concat();
    let steps = view.index;
    let counts = *stepper.counts();
    let kept = |outcome: &Outcome| outcome.energy_conserved() || *outcome == Outcome::Quadratic;
    Leg {
        seconds: match ending {
            Ending::Cut => seconds * task.steps as f64 / steps as f64,
            _ => seconds,
        },
        ending,
        state,
        work: Work {
            gradients: counts.gradients,
            hessians: counts.hessians,
            fixed_point_iterations: counts.fixed_point_iterations,
            newton_iterations: counts.newton_iterations,
            factorisations: counts.factorisations + counts.simplified_factorisations,
        },
        outcomes: Outcome::ALL
            .iter()
            .map(|&outcome| (format!("{outcome:?}"), counts.outcome(outcome)))
            .filter(|&(_, steps)| steps > 0)
            .collect(),
        steps,
        kept: Outcome::ALL
            .iter()
            .filter(|outcome| kept(outcome))
            .map(|&outcome| counts.outcome(outcome))
            .sum(),
        energy,
        floor,
    }
}

impl Leg {
    fn without_steps(error: String, task: &Task<'_>) -> Self {
        Leg {
            ending: Ending::Failed(error),
            seconds: 0.0,
            state: [task.q, task.p].concat(),
            work: Work::default(),
            outcomes: Vec::new(),
            steps: 0,
            kept: 0,
            energy: 0.0,
            floor: 0.0,
        }
    }
}
