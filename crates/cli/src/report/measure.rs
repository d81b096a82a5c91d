//! Which settings are run, and the times of interleaved repeats.
//!
//! Every method climbs from coarse to fine settings until it is slow, at its floor, or as accurate as its
//! numbers allow. Then all runs of a scene are repeated in turn, so that a slow spell of the machine does not
//! hit one method alone, as often as the budget allows.

use super::contender::{Contender, Outcome};
use super::subject::Subject;
use equip_scalar::Float;
use std::time::{Duration, Instant};

/// Settings of a method at most.
const SETTINGS: i32 = 14;
/// Repeats at most.
const REPEATS: usize = 9;

/// A method with one setting.
#[derive(Debug, Clone)]
pub(super) struct Point {
    pub(super) setting: f64,
    pub(super) outcome: Outcome,
    /// Milliseconds of the repeats, ascending.
    pub(super) milliseconds: Vec<f64>,
}

impl Point {
    pub(super) fn median(&self) -> f64 {
        self.repeat(self.milliseconds.len() / 2)
    }

    /// Least and most.
    pub(super) fn spread(&self) -> (f64, f64) {
        let last = self.milliseconds.len().saturating_sub(1);
        (self.repeat(0), self.repeat(last))
    }

    fn repeat(&self, k: usize) -> f64 {
        self.milliseconds.get(k).copied().unwrap_or(f64::NAN)
    }
}

/// A method with all its settings, from coarse to fine.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    pub(super) contender: Contender,
    pub(super) points: Vec<Point>,
    /// Why the finest settings failed, if they did.
    pub(super) failure: Option<String>,
}

/// How much time a scene may take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Budget {
    /// For one run.
    pub(super) run: Duration,
    /// For all runs of the scene with their repeats.
    pub(super) scene: Duration,
}

/// Runs all methods on a scene.
pub(super) fn curves<T: Float>(
    subject: &Subject<T>,
    contenders: &[Contender],
    budget: Budget,
    say: impl Fn(String),
) -> Vec<Curve> {
    let begun = Instant::now();
    // The climbs may use half of the time; the rest is for repeats.
    let share = budget.scene / (2 * contenders.len().max(1) as u32);
    let name = format!("{} {}", subject.name, T::NAME);
    let mut curves = Vec::new();
    for contender in contenders {
        say(format!("{name}: {}", contender.name()));
        curves.push(climb(subject, *contender, budget.run, share));
    }
    for round in 0..REPEATS {
        say(format!("{name}: repeat {}", round + 1));
        let round_begun = Instant::now();
        for curve in &mut curves {
            for point in &mut curve.points {
                // It ran before with this setting.
                if let Ok(seconds) = curve.contender.time(subject, point.setting) {
                    point.milliseconds.push(1e3 * seconds);
                }
            }
        }
        if begun.elapsed() + round_begun.elapsed() > budget.scene {
            break;
        }
    }
    for point in curves.iter_mut().flat_map(|c| &mut c.points) {
        point.milliseconds.sort_by(f64::total_cmp);
    }
    curves
}

fn climb<T: Float>(
    subject: &Subject<T>,
    contender: Contender,
    most: Duration,
    share: Duration,
) -> Curve {
    let begun = Instant::now();
    let mut curve = Curve {
        contender,
        points: Vec::new(),
        failure: None,
    };
    let (mut best, mut worse, mut slow) = (f64::INFINITY, 0, 0);
    for k in 0..SETTINGS {
        let setting = contender.setting(subject, k);
        if contender.adapts && setting < T::EPSILON.to_f64() {
            break;
        }
        let run_begun = Instant::now();
        match contender.watch(subject, setting) {
            Ok(outcome) => {
                let is_better = outcome.error < 0.5 * best;
                worse = if is_better { 0 } else { worse + 1 };
                best = best.min(outcome.error);
                curve.points.push(Point {
                    setting,
                    outcome,
                    milliseconds: Vec::new(),
                });
            }
            // A coarse setting may well fail; finer ones are tried.
            Err(failure) => curve.failure = Some(failure),
        }
        let at_round_off = worse >= 2 && best < T::EPSILON.to_f64().sqrt();
        // Coarse settings may be slow where steps fail and are halved; finer ones then are faster.
        let is_slow = run_begun.elapsed() > most;
        slow = if is_slow { slow + 1 } else { 0 };
        if at_round_off || slow >= 3 || begun.elapsed() > share {
            break;
        }
    }
    curve
}
