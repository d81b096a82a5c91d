//! The progress bar of long runs on a terminal.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

/// Runs shorter than this show no bar.
const PATIENCE: Duration = Duration::from_secs(1);

#[derive(Debug)]
pub(crate) struct Progress {
    begun: Instant,
    name: &'static str,
    steps: u64,
    wanted: bool,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// A bar for the run `name` of so many steps, if it is `wanted` and there is a terminal to see it.
    pub(crate) fn new(name: &'static str, steps: u64, wanted: bool) -> Self {
        let wanted = wanted && stderr().is_terminal();
        Progress {
            begun: Instant::now(),
            name,
            steps,
            wanted,
            bar: None,
        }
    }

    /// Steps of the whole run.
    pub(crate) fn steps(&self) -> u64 {
        self.steps
    }

    pub(crate) fn see(&mut self, index: u64) {
        if !self.wanted {
            return;
        }
        if self.bar.is_none() && self.begun.elapsed() > PATIENCE {
            let bar = ProgressBar::new(self.steps).with_message(self.name);
            let style = ProgressStyle::with_template(
                "{msg} {bar:40} {percent}% of {len} steps, {eta} to go",
            );
            self.bar = Some(bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())));
        }
        if let Some(bar) = &self.bar {
            bar.set_position(index);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A bar over a known number of things on a terminal, nothing elsewhere.
pub(crate) fn steps_of(things: &str, count: usize) -> ProgressBar {
    if !stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template(&format!(
        "{{bar:40}} {{pos}} of {{len}} {things}, {{elapsed}}  {{msg}}"
    ));
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(count as u64).with_style(style)
}
