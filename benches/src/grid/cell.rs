//! One cell of the grid: a scene, a start, stages and a step, and what both methods showed there.

use crate::contestant::{Contestant, Ending, Leg, Task, run};
use equip_tests::apart;
use std::time::Duration;

/// Steps of a run.
pub(crate) const STEPS: u64 = 40;

/// What kind of a step it is, judged by Gauss's own error and by h·ω, ω the fastest frequency along the
/// motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Regime {
    /// Gauss's error is at most 1e-3 of the motion.
    Resolved,
    /// The same in a stiff scene.
    StiffResolved,
    /// Gauss's error is larger, up to a third of the motion.
    Coarse,
    /// h·ω > 2s, where the Legendre coefficients of the fastest motion do not decay, or the error is larger
    /// still.
    Unresolved,
    /// Gauss ends in an error, or does not end in time.
    Unsolved,
}

impl Regime {
    pub(crate) const ALL: [Regime; 5] = [
        Regime::Resolved,
        Regime::StiffResolved,
        Regime::Coarse,
        Regime::Unresolved,
        Regime::Unsolved,
    ];

    pub(crate) fn label(self) -> &'static str {
        match self {
            Regime::Resolved => "resolved",
            Regime::StiffResolved => "stiff resolved",
            Regime::Coarse => "coarse",
            Regime::Unresolved => "unresolved",
            Regime::Unsolved => "Gauss fails",
        }
    }

    fn of(gauss: &Leg, error: f64, angle: f64, stages: usize, is_stiff: bool) -> Self {
        if gauss.ending != Ending::Done {
            Regime::Unsolved
        } else if angle > 2.0 * stages as f64 || !(error <= 1.0 / 3.0) {
            Regime::Unresolved
        } else if error > 1e-3 {
            Regime::Coarse
        } else if is_stiff {
            Regime::StiffResolved
        } else {
            Regime::Resolved
        }
    }
}

/// Errors below this are not compared.
pub(crate) const LEAST_ERROR: f64 = 1e-12;

#[derive(Debug, Clone)]
pub(crate) struct Cell {
    pub(crate) scene: &'static str,
    /// 0 is the scene's own start, the others are random.
    pub(crate) start: u64,
    pub(crate) stages: usize,
    pub(crate) step: f64,
    pub(crate) steps: u64,
    /// h·ω.
    pub(crate) angle: f64,
    pub(crate) regime: Regime,
    pub(crate) equip: Leg,
    pub(crate) gauss: Leg,
    /// Errors at the end, relative to the size of the motion, of EQUIP and of Gauss.
    pub(crate) errors: [f64; 2],
    /// Bound of the error of the reference.
    pub(crate) reference_error: f64,
    /// ε (|H| + Σ |y_i ∂_i H|) at its largest along the motion.
    pub(crate) round_off: f64,
}

/// What a cell is measured against.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Truth<'a> {
    pub(crate) state: &'a [f64],
    pub(crate) error: f64,
    pub(crate) sizes: [f64; 2],
    pub(crate) rate: f64,
    pub(crate) round_off: f64,
    pub(crate) is_stiff: bool,
}

/// How long repeats go on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Patience {
    pub(crate) repeats: u32,
    pub(crate) seconds: f64,
}

/// A run that takes more than so many times the CPU time of Gauss, and the rest besides, is cut.
const CUT: f64 = 60.0;
const CUT_BESIDES: Duration = Duration::from_millis(20);
/// No run takes longer than this.
const LONGEST: Duration = Duration::from_secs(2);
/// Runs that take so many seconds are not repeated.
const LONG: f64 = 0.1;

impl Cell {
    pub(crate) fn measure(
        (scene, start): (&'static str, u64),
        task: &Task<'_>,
        truth: Truth<'_>,
        patience: Patience,
    ) -> Self {
        let mut gauss = run(Contestant::Gauss, task, LONGEST);
        let limit = |gauss: &Leg| match gauss.ending {
            Ending::Done => LONGEST.min(Duration::from_secs_f64(CUT * gauss.seconds) + CUT_BESIDES),
            _ => CUT_BESIDES,
        };
        let mut equip = run(Contestant::Equip, task, limit(&gauss));
        let mut spent = gauss.seconds + equip.seconds;
        let mut repeats = 1;
        // The first of them warms caches up, so that there are two at least of short ones.
        while (repeats < 2 && spent < LONG)
            || (repeats < patience.repeats && spent < patience.seconds)
        {
            let again = run(Contestant::Gauss, task, LONGEST);
            spent += again.seconds;
            gauss.seconds = gauss.seconds.min(again.seconds);
            if equip.ending == Ending::Done {
                let again = run(Contestant::Equip, task, LONGEST);
                spent += again.seconds;
                equip.seconds = equip.seconds.min(again.seconds);
            }
            repeats += 1;
        }
        let error = |leg: &Leg| match leg.ending {
            Ending::Done => apart(&leg.state, truth.state, truth.sizes),
            _ => f64::NAN,
        };
        let errors = [error(&equip), error(&gauss)];
        let angle = task.step * truth.rate;
        Cell {
            scene,
            start,
            stages: task.stages,
            step: task.step,
            steps: task.steps,
            angle,
            regime: Regime::of(&gauss, errors[1], angle, task.stages, truth.is_stiff),
            equip,
            gauss,
            errors,
            reference_error: truth.error,
            round_off: truth.round_off,
        }
    }

    /// Time over Gauss's, where Gauss made its steps and EQUIP made them or was cut.
    pub(crate) fn time_ratio(&self) -> Option<f64> {
        let ended = self.gauss.ending == Ending::Done
            && matches!(self.equip.ending, Ending::Done | Ending::Cut);
        ended.then(|| self.equip.seconds / self.gauss.seconds)
    }

    /// Error over Gauss's, where one of them is above [`LEAST_ERROR`] and the reference is good enough; the
    /// smaller one counts as that much then.
    pub(crate) fn error_ratio(&self) -> Option<f64> {
        let [equip, gauss] = self.errors;
        let known = self.reference_error < 0.1 * LEAST_ERROR;
        (known && equip.max(gauss) > LEAST_ERROR && equip.is_finite() && gauss.is_finite())
            .then(|| equip.max(LEAST_ERROR) / gauss.max(LEAST_ERROR))
    }

    /// Largest |H − H_ref| over Gauss's, or over round-off where Gauss is below that.
    pub(crate) fn energy_ratio(&self) -> Option<f64> {
        let round_off = self.round_off.max(self.equip.floor);
        (self.equip.ending == Ending::Done && self.gauss.ending == Ending::Done)
            .then(|| self.equip.energy / self.gauss.energy.max(round_off))
    }

    /// Work in gradients, a Hessian counting as `n` of them: EQUIP's and Gauss's.
    pub(crate) fn work(&self) -> [u64; 2] {
        let n = self.equip.state.len() as u64;
        [&self.equip, &self.gauss].map(|leg| leg.work.gradients + n * leg.work.hessians)
    }

    /// EQUIP ends in an error where Gauss does not.
    pub(crate) fn fails_alone(&self) -> bool {
        self.gauss.ending == Ending::Done && matches!(self.equip.ending, Ending::Failed(_))
    }
}
