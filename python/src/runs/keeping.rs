//! [`Keeping`]: checkpoints of a run in a file, now and then, at its end, and when it is interrupted.

use crate::faults::value_error;
use equip::prelude::Checkpoint;
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How often a checkpoint is written.
const EVERY: Duration = Duration::from_secs(60);

/// Where checkpoints of a run to `end` are kept.
pub(crate) struct Keeping {
    path: PathBuf,
    end: f64,
    written: Instant,
}

impl Keeping {
    pub(crate) fn new(path: PathBuf, end: f64) -> Self {
        Keeping {
            path,
            end,
            written: Instant::now(),
        }
    }

    /// Whether a step to `time` is one to write down.
    pub(crate) fn is_due(&self, time: f64) -> bool {
        time == self.end || self.written.elapsed() >= EVERY
    }

    /// The file has the one or the other checkpoint at any time, never a part of one.
    pub(crate) fn write(&mut self, checkpoint: &Checkpoint) -> PyResult<()> {
        let text = serde_json::to_vec(checkpoint).map_err(value_error)?;
        let mut beside = self.path.clone().into_os_string();
        beside.push(".new");
        let failed = |error: std::io::Error| {
            PyOSError::new_err(format!("checkpoint {}: {error}", self.path.display()))
        };
        std::fs::write(&beside, text).map_err(failed)?;
        std::fs::rename(&beside, &self.path).map_err(failed)?;
        self.written = Instant::now();
        Ok(())
    }
}

/// The checkpoint in a file; `None` if there is no file.
pub(crate) fn read(path: &Path) -> PyResult<Option<Checkpoint>> {
    let shown = path.display();
    match std::fs::read(path) {
        Ok(text) => serde_json::from_slice(&text).map(Some).map_err(|error| {
            value_error(format!(
                "{shown} is no checkpoint of this version: {error}; give another path, or remove the file"
            ))
        }),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(PyOSError::new_err(format!("checkpoint {shown}: {error}"))),
    }
}
