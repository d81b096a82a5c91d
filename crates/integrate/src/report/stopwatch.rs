//! [`Stopwatch`]: the wall-clock time of a run.

use std::time::{Duration, Instant};

/// In a browser `Instant::now` panics.
const HAS_CLOCK: bool = !cfg!(all(target_family = "wasm", target_os = "unknown"));

/// The time since the start of a run; 0 if there is no clock.
#[derive(Debug)]
pub(crate) struct Stopwatch(Option<Instant>);

impl Stopwatch {
    /// For a run that begins now.
    pub(crate) fn start() -> Self {
        Stopwatch(HAS_CLOCK.then(Instant::now))
    }

    /// For a run that has already taken the time `before`.
    pub(crate) fn after(before: Duration) -> Self {
        let Stopwatch(now) = Self::start();
        Stopwatch(now.map(|now| now.checked_sub(before).unwrap_or(now)))
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.0.map_or(0.0, |begun| begun.elapsed().as_secs_f64())
    }
}
