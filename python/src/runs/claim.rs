//! [`Claim`]: a file that one process writes at a time, by the lock of a file next to it.
//!
//! The system releases the lock when the process ends, however it ends. Systems without locks have none.

use crate::faults::{FileInUseError, os_error};
use pyo3::prelude::*;
use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A name that this process alone writes until the claim is released.
#[pyclass(frozen, module = "equip._native")]
pub(crate) struct Claim {
    /// None once it is released.
    held: Mutex<Option<Lock>>,
}

struct Lock {
    path: PathBuf,
    _file: File,
}

impl Claim {
    pub(crate) fn of(name: &Path) -> PyResult<Self> {
        let mut path = name.to_owned().into_os_string();
        path.push(".lock");
        let path = PathBuf::from(path);
        let failed = |error: std::io::Error| os_error("checkpoint", name, &error);
        loop {
            let mut options = OpenOptions::new();
            let options = options.write(true).create(true).truncate(false);
            let file = options.open(&path).map_err(failed)?;
            if let Err(TryLockError::WouldBlock) = file.try_lock() {
                return Err(FileInUseError::new_err(format!(
                    "another process is writing {}: give each process its own checkpoint, or wait for \
                     the other one to end",
                    name.display()
                )));
            }
            // The file of a process that ended between the opening and the lock is no longer there.
            if is_at(&file, &path) {
                let held = Mutex::new(Some(Lock { path, _file: file }));
                return Ok(Claim { held });
            }
        }
    }
}

#[pymethods]
impl Claim {
    #[new]
    fn new(name: PathBuf) -> PyResult<Self> {
        Self::of(&name)
    }

    /// Lets other processes write the file.
    fn release(&self) {
        drop(
            self.held
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .take(),
        );
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A file that stays is taken by the next process.
        let _ = std::fs::remove_file(&self.path);
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(one), Ok(other)) => (one.dev(), one.ino()) == (other.dev(), other.ino()),
        _ => false,
    }
}

/// Open files are not removed.
#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> bool {
    true
}
