//! [`Keeping`]: checkpoints of a run in a file, now and then, at its end, and when it is interrupted.

use crate::faults::{FileFormatError, os_error, value_error};
use crate::runs::claim::Claim;
use equip::prelude::Checkpoint;
use pyo3::prelude::*;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Where checkpoints of a run to `end` are kept.
pub(crate) struct Keeping {
    path: PathBuf,
    end: f64,
    every: Duration,
    written: Instant,
    /// No other process writes the file meanwhile.
    _claim: Claim,
}

impl Keeping {
    pub(crate) fn new(path: PathBuf, end: f64, every: Duration) -> PyResult<Self> {
        Ok(Keeping {
            _claim: Claim::of(&path)?,
            path,
            end,
            every,
            written: Instant::now(),
        })
    }

    /// The checkpoint of an earlier run; `None` if there is no file.
    pub(crate) fn read(&self) -> PyResult<Option<Checkpoint>> {
        let shown = self.path.display();
        match std::fs::read(&self.path) {
            Ok(text) => serde_json::from_slice(&text).map(Some).map_err(|error| {
                FileFormatError::new_err(format!(
                    "{shown} is not a checkpoint of this version: {error}; give another path, or remove the file"
                ))
            }),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(os_error("checkpoint", &self.path, &error)),
        }
    }

    /// Whether a step to `time` is one to write down.
    pub(crate) fn is_due(&self, time: f64) -> bool {
        time == self.end || self.written.elapsed() >= self.every
    }

    /// The file has the one or the other checkpoint at any time, never a part of one.
    pub(crate) fn write(&mut self, checkpoint: &Checkpoint) -> PyResult<()> {
        let text = serde_json::to_vec(checkpoint).map_err(value_error)?;
        let mut new = self.path.clone().into_os_string();
        new.push(format!(".{}.new", std::process::id()));
        let new = PathBuf::from(new);
        let written = replace(&new, &text, &self.path);
        written.map_err(|error| {
            let _ = std::fs::remove_file(&new);
            os_error("checkpoint", &self.path, &error)
        })?;
        self.written = Instant::now();
        Ok(())
    }
}

/// Writes a new file, and puts it in the place of `path` once it is on the disk.
fn replace(new: &Path, text: &[u8], path: &Path) -> std::io::Result<()> {
    let mut file = File::create(new)?;
    file.write_all(text)?;
    file.sync_all()?;
    std::fs::rename(new, path)
}
