//! The order of the runs: what settings are tried, which of them are timed, and what counts.
//!
//! 1. Every contestant climbs its ladder from coarse to fine, until it is slower than the cap or no longer
//!    improves.
//! 2. Between the last setting that misses a target and the first that reaches it, settings are halved
//!    geometrically; and so they are on both sides of the quickest that reaches it, which need not be the
//!    coarsest.
//! 3. For each target every contestant's quickest setting that reaches it is timed again, all contestants in
//!    turn, for a number of rounds; what counts is the median over the rounds.
//!
//! A setting *reaches* a target if its error and that of the next finer setting tried are within it: a lucky
//! hit alone does not.

use crate::contestant::{Contestant, Knob};
use crate::task::Task;

/// Seconds a single run should take at most.
const CAP: f64 = 3.0;
/// A climb ends when it is slower by this factor than the quickest so far at the last target that anyone
/// reaches.
const FAR_BEHIND: f64 = 30.0;
/// Contestants slower by this factor at a target are not timed again there.
const HOPELESS: f64 = 20.0;
/// Bisections at each target.
const BISECTIONS: usize = 2;

/// A setting that was run.
#[derive(Debug, Clone)]
pub struct Tried {
    pub setting: f64,
    pub error: f64,
    pub steps: Option<u64>,
    /// CPU seconds of all turns, the first from the climb.
    pub seconds: Vec<f64>,
}

impl Tried {
    /// The median over the rounds; before there are any, the time of the climb.
    pub fn median(&self) -> f64 {
        let (median, ..) = self.spread();
        median
    }

    /// Median, smallest and largest.
    pub fn spread(&self) -> (f64, f64, f64) {
        let mut rounds = match self.seconds.as_slice() {
            [first] => vec![*first],
            [_, rounds @ ..] => rounds.to_vec(),
            [] => vec![f64::NAN],
        };
        rounds.sort_by(f64::total_cmp);
        (
            rounds[rounds.len() / 2],
            rounds[0],
            rounds[rounds.len() - 1],
        )
    }
}

/// A contestant with all it tried, from coarse to fine.
pub struct Lane {
    pub contestant: Box<dyn Contestant>,
    pub tried: Vec<Tried>,
    /// The last failure, if there was one.
    pub failure: Option<String>,
}

impl Lane {
    /// Index of the quickest setting that reaches `target`; once some have been timed again, of those.
    pub fn quickest(&self, target: f64) -> Option<usize> {
        let reaches = |i: usize| {
            let next = self.tried.get(i + 1);
            self.tried[i].error <= target && next.is_none_or(|n| n.error <= target)
        };
        let time = |i: &usize| self.tried[*i].median();
        let once = |i: &usize| self.tried[*i].seconds.len() == 1;
        let order = |a: &usize, b: &usize| once(a).cmp(&once(b)).then(time(a).total_cmp(&time(b)));
        (0..self.tried.len()).filter(|&i| reaches(i)).min_by(order)
    }

    /// Index of the setting that is the tolerance `tolerance`, if the contestant has one.
    pub fn at_tolerance(&self, tolerance: f64) -> Option<usize> {
        let same = |t: &Tried| (t.setting / tolerance).ln().abs() < 0.1;
        let found = self.tried.iter().position(same);
        found.filter(|_| self.contestant.ladder().knob == Knob::Tolerance)
    }

    fn try_setting(&mut self, setting: f64, task: &Task) -> Option<&Tried> {
        match self.contestant.run(setting) {
            Ok(ran) => {
                let tried = Tried {
                    setting,
                    error: task.error(&ran.end),
                    steps: ran.steps,
                    seconds: vec![ran.seconds],
                };
                let finer = self.contestant.ladder().factor > 1.0;
                let before = |t: &Tried| {
                    if finer {
                        t.setting < setting
                    } else {
                        t.setting > setting
                    }
                };
                let place = self.tried.partition_point(before);
                self.tried.insert(place, tried);
                self.tried.get(place)
            }
            Err(failure) => {
                self.failure = Some(failure);
                None
            }
        }
    }

    fn climb(&mut self, task: &Task, (cap, hardest): (f64, f64)) {
        let (mut best, mut before) = (f64::INFINITY, f64::INFINITY);
        let (mut worse, mut failed, mut slow) = (0, 0, 0);
        for setting in self.contestant.ladder().settings() {
            let Some(tried) = self.try_setting(setting, task) else {
                // Coarse settings may well fail.
                failed += 1;
                if failed < 4 || self.tried.is_empty() {
                    continue;
                }
                break;
            };
            failed = 0;
            let last = task.targets[task.targets.len() - 1];
            worse = if tried.error < 0.7 * best {
                0
            } else {
                worse + 1
            };
            best = best.min(tried.error);
            let floor = best < 1e-7 && worse >= 7;
            // Coarse settings may be slow where steps fail and are halved; as long as finer ones are faster,
            // there is hope.
            let time = tried.median();
            // What is more accurate than all others so far may take its time.
            let cap = if tried.error > hardest { cap } else { CAP };
            slow = match time {
                time if time <= cap || time < 0.9 * before => 0,
                time if time > CAP => slow + 2,
                _ => slow + 1,
            };
            before = time;
            if slow >= 4 || best <= 0.01 * last || floor {
                break;
            }
        }
    }

    fn bisect(&mut self, task: &Task) {
        let ladder = self.contestant.ladder();
        for &target in task.targets {
            for _ in 0..BISECTIONS {
                let first = self.tried.iter().position(|t| t.error <= target);
                let Some(i) = first.filter(|&i| i > 0) else {
                    break;
                };
                let (a, b) = (self.tried[i - 1].setting, self.tried[i].setting);
                let middle = ladder.between(a, b);
                if middle == a || middle == b || self.try_setting(middle, task).is_none() {
                    break;
                }
            }
        }
    }

    /// On both sides of the quickest settings.
    fn refine(&mut self, task: &Task) {
        let ladder = self.contestant.ladder();
        for &target in task.targets {
            for _ in 0..BISECTIONS {
                let Some(i) = self.quickest(target) else {
                    break;
                };
                let near = i.saturating_sub(1)..(i + 2).min(self.tried.len());
                let settings: Vec<f64> = self.tried[near].iter().map(|t| t.setting).collect();
                for pair in settings.windows(2) {
                    let middle = ladder.between(pair[0], pair[1]);
                    if !pair.contains(&middle) {
                        self.try_setting(middle, task);
                    }
                }
            }
        }
    }
}

/// Seconds a run may take that misses an error, and that error: the hardest one that a contestant so far
/// reaches.
fn cap(task: &Task, lanes: &[Lane]) -> (f64, f64) {
    let quickest = |&target: &f64| {
        let times = lanes
            .iter()
            .filter_map(|lane| Some(lane.tried[lane.quickest(target)?].median()));
        Some((times.reduce(f64::min)?, target))
    };
    match task.targets.iter().rev().find_map(quickest) {
        // Number types of different widths are too far apart for this.
        Some((seconds, target)) if !task.extended() => (CAP.min(FAR_BEHIND * seconds), target),
        _ => (CAP, 0.0),
    }
}

/// Runs the race, peers first; `say` is told what is being done.
pub fn race(
    task: &Task,
    contestants: Vec<Box<dyn Contestant>>,
    rounds: usize,
    mut say: impl FnMut(&str),
) -> Vec<Lane> {
    let mut lanes: Vec<Lane> = Vec::new();
    for contestant in contestants {
        say(&format!(
            "{}: {}, {}",
            task.name,
            contestant.program(),
            contestant.method()
        ));
        let mut lane = Lane {
            contestant,
            tried: Vec::new(),
            failure: None,
        };
        lane.climb(task, cap(task, &lanes));
        lane.bisect(task);
        lane.refine(task);
        lanes.push(lane);
    }
    let mut again: Vec<(usize, usize)> = Vec::new();
    for &target in task.targets {
        let reached: Vec<(usize, usize)> = (0..lanes.len())
            .filter_map(|k| Some((k, lanes[k].quickest(target)?)))
            .collect();
        let time = |&(k, i): &(usize, usize)| lanes[k].tried[i].median();
        let least = reached.iter().map(time).fold(f64::INFINITY, f64::min);
        again.extend(reached.iter().filter(|run| time(run) <= HOPELESS * least));
    }
    if let Some(tolerance) = task.tolerance {
        let found = |k: usize| Some((k, lanes[k].at_tolerance(tolerance)?));
        again.extend((0..lanes.len()).filter_map(found));
    }
    again.sort_unstable();
    again.dedup();
    for round in 0..rounds {
        say(&format!(
            "{}: round {} of {rounds}, {} runs",
            task.name,
            round + 1,
            again.len()
        ));
        for &(k, i) in &again {
            let lane = &mut lanes[k];
            let tried = &mut lane.tried[i];
            // It ran before with this setting.
            if let Ok(ran) = lane.contestant.run(tried.setting) {
                tried.seconds.push(ran.seconds);
            }
        }
    }
    lanes
}
