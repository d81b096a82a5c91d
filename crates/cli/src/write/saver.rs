//! Checkpoints of `equip run` in a file, and Ctrl-C.
//!
//! A checkpoint is written to a file of its own beside the one asked for and then takes its name: whenever the program ends, the file is a
//! whole checkpoint, the last or the one before it.

use crate::fault::Fault;
use equip_integrate::Checkpoint;
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Set by Ctrl-C.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From here on Ctrl-C ends the run after its present step, with everything written; a second one ends the program at once.
pub(crate) fn catch_interrupts() -> Result<(), Fault> {
    ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .map_err(|error| Fault::Start(Box::new(error)))
}

pub(crate) fn interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// When and where checkpoints are written.
#[derive(Debug)]
pub(crate) struct Saver {
    path: PathBuf,
    every: Duration,
    last: Instant,
}

impl Saver {
    pub(crate) fn new(path: &Path, every: Duration) -> Self {
        Saver {
            path: path.to_owned(),
            every,
            last: Instant::now(),
        }
    }

    pub(crate) fn is_due(&self) -> bool {
        interrupted() || self.last.elapsed() >= self.every
    }

    pub(crate) fn save(&mut self, checkpoint: &Checkpoint) -> Result<(), Fault> {
        let fault = |source| Fault::Write {
            path: self.path.clone(),
            source,
        };
        let mut name = self.path.clone().into_os_string();
        name.push(".new");
        let new = PathBuf::from(name);
        let mut file = BufWriter::new(File::create(&new).map_err(fault)?);
        serde_json::to_writer(&mut file, checkpoint).map_err(|e| fault(e.into()))?;
        file.flush().map_err(fault)?;
        file.get_ref().sync_all().map_err(fault)?;
        std::fs::rename(&new, &self.path).map_err(fault)?;
        self.last = Instant::now();
        Ok(())
    }
}

/// The checkpoint in a file; `None` if there is no such file.
pub(crate) fn load(path: &Path) -> Result<Option<Checkpoint>, Fault> {
    let fault = |source| Fault::Checkpoint {
        path: path.to_owned(),
        source,
    };
    match std::fs::read(path) {
        Ok(text) => serde_json::from_slice(&text).map(Some).map_err(fault),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(fault(serde_json::Error::io(error))),
    }
}
