//! Files that one program writes at a time.
//!
//! The locks are advisory and belong to open files: the system takes them off when a program ends, however it
//! ends. Devices and pipes have none, nor have files on systems without locks.

use crate::fault::Fault;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Opens a file for writing, locked; it is made if it is not there, and what is in it stays.
///
/// # Errors
/// [`Fault::InUse`] if another program has it, [`Fault::Write`] if it cannot be written.
pub(crate) fn open(path: &Path) -> Result<File, Fault> {
    let mut options = OpenOptions::new();
    locked(path, options.write(true).create(true).truncate(false))
}

/// Opens a file for reading and writing, locked; it must be there.
///
/// # Errors
/// As of [`open`].
pub(crate) fn reopen(path: &Path) -> Result<File, Fault> {
    locked(path, OpenOptions::new().read(true).write(true))
}

/// Drops what is in a file. A device or a pipe has nothing to drop.
pub(crate) fn empty(file: &File) -> io::Result<()> {
    match file.metadata()?.is_file() {
        true => file.set_len(0),
        false => Ok(()),
    }
}

/// Refuses a directory or a device where a file is to be replaced by another.
///
/// # Errors
/// [`Fault::Option`].
pub(crate) fn ordinary(option: &'static str, path: &Path) -> Result<(), Fault> {
    match std::fs::metadata(path) {
        Ok(found) if !found.is_file() => {
            Err(Fault::option(option, path.display(), "an ordinary file"))
        }
        // What else is wrong shows when it is opened.
        _ => Ok(()),
    }
}

fn locked(path: &Path, options: &OpenOptions) -> Result<File, Fault> {
    let file = (options.open(path)).map_err(|source| unwritten(path, source))?;
    let metadata = (file.metadata()).map_err(|source| unwritten(path, source))?;
    match metadata.is_file().then(|| file.try_lock()) {
        Some(Err(TryLockError::WouldBlock)) => Err(Fault::InUse {
            path: path.to_owned(),
        }),
        Some(Ok(()) | Err(TryLockError::Error(_))) | None => Ok(file),
    }
}

pub(crate) fn unwritten(path: &Path, source: io::Error) -> Fault {
    let path = path.to_owned();
    match source.kind() {
        ErrorKind::FileTooLarge | ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            let advice = "";
            Fault::NoRoom {
                path,
                source,
                advice,
            }
        }
        _ => Fault::Write { path, source },
    }
}

/// A name that this program alone uses, by a locked file beside it. It is for files that are replaced while
/// they are written, which take no lock of their own.
#[derive(Debug)]
pub(crate) struct Claim {
    path: PathBuf,
    /// Holds the lock.
    _file: File,
}

impl Claim {
    /// # Errors
    /// [`Fault::InUse`] with `name` if another program has claimed it, [`Fault::Start`] if the file beside it
    /// cannot be made, [`Fault::Option`] if it is no ordinary file.
    pub(crate) fn new(option: &'static str, name: &Path) -> Result<Self, Fault> {
        let path = beside(name);
        ordinary(option, &path)?;
        loop {
            let file = open(&path).map_err(|fault| match fault {
                Fault::InUse { .. } => Fault::InUse {
                    path: name.to_owned(),
                },
                Fault::Write { source, .. } => Fault::Start(Box::new(unwritten(name, source))),
                other => other,
            })?;
            // The file of a program that ended between the opening and the lock is no longer there.
            if is_at(&file, &path) {
                return Ok(Claim { path, _file: file });
            }
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // A file that stays is taken by the next program.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// The file whose lock claims a name.
pub(crate) fn beside(name: &Path) -> PathBuf {
    let mut path = name.to_owned().into_os_string();
    path.push(".lock");
    PathBuf::from(path)
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

#[cfg(test)]
mod tests {
    use super::{Claim, beside, empty, open};
    use crate::fault::Fault;
    use std::io::Write;

    #[test]
    fn a_file_is_written_by_one_and_keeps_what_is_in_it() {
        let path = std::env::temp_dir().join(format!("equip-lock-{}", std::process::id()));
        let mut first = open(&path).unwrap();
        first.write_all(b"whole").unwrap();
        assert!(matches!(open(&path), Err(Fault::InUse { .. })));
        assert_eq!(std::fs::read(&path).unwrap(), b"whole");
        drop(first);
        let second = open(&path).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"whole");
        empty(&second).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"");
        std::fs::remove_file(&path).unwrap();
    }

    #[test]
    fn a_claim_is_taken_off_and_one_left_behind_does_not_block() {
        let name = std::env::temp_dir().join(format!("equip-claim-{}", std::process::id()));
        std::fs::write(beside(&name), "").unwrap();
        let first = Claim::new("--out", &name).unwrap();
        let Err(Fault::InUse { path }) = Claim::new("--out", &name) else {
            panic!("claimed twice");
        };
        assert_eq!(path, name);
        drop(first);
        assert!(!beside(&name).exists());
        drop(Claim::new("--out", &name).unwrap());
    }
}
