//! [`Stopwatch`]: the seconds that a run takes.

use std::time::{Duration, Instant};

/// In a browser `Instant::now` panics.
const HAS_CLOCK: bool = !cfg!(all(target_family = "wasm", target_os = "unknown"));

/// The time since a run has begun; 0 where there is no clock.
#[derive(Debug)]
pub(crate) struct Stopwatch(Option<Instant>);

impl Stopwatch {
    /// Of a run that begins now.
    pub(crate) fn start() -> Self {
        Stopwatch(HAS_CLOCK.then(Instant::now))
    }

    /// Of a run that has taken so long already.
    pub(crate) fn after(before: Duration) -> Self {
        let Stopwatch(now) = Self::start();
        Stopwatch(now.map(|now| now.checked_sub(before).unwrap_or(now)))
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.0.map_or(0.0, |begun| begun.elapsed().as_secs_f64())
    }
}
