//! The progress bar of long runs on a terminal.

use indicatif::{ProgressBar, ProgressStyle};
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
    /// A bar for the run `name` of so many steps, if it is `wanted`; it is seen on a terminal only.
    pub(crate) fn new(name: &'static str, steps: u64, wanted: bool) -> Self {
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
            let template = "{msg} {bar:40} {percent}% of {len} steps, {eta} to go";
            self.bar = Some(styled(self.steps, template).with_message(self.name));
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
    let template = format!("{{bar:40}} {{pos}} of {{len}} {things}, {{elapsed}}  {{msg}}");
    styled(count as u64, &template)
}

fn styled(length: u64, template: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(template);
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style)
}
