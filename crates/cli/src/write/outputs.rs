//! Files that a command writes: apart from each other, and opened before the work.

use crate::fault::Fault;
use crate::write::lock::{self, unwritten};
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Refuses two outputs in one file.
///
/// # Errors
/// [`Fault::SameFile`], with the options of both.
pub(crate) fn apart(outputs: &[(&'static str, Option<&Path>)]) -> Result<(), Fault> {
    for (i, (one, path)) in outputs.iter().enumerate() {
        for (other, second) in &outputs[i + 1..] {
            if let (Some(path), Some(second)) = (path, second)
                && place(path) == place(second)
            {
                return Err(Fault::SameFile {
                    options: (one, other),
                    path: path.to_path_buf(),
                });
            }
        }
    }
    Ok(())
}

/// The standard output, if it is an ordinary file. Another output in that file would be written over
/// it.
pub(crate) fn printed() -> (&'static str, Option<&'static Path>) {
    let path = Path::new("/dev/stdout");
    ("the standard output", path.is_file().then_some(path))
}

/// The file that a link leads to, whether it is there or not; other paths as they are.
pub(crate) fn behind_link(path: PathBuf) -> PathBuf {
    match path.is_symlink() {
        true => place(&path),
        false => path,
    }
}

/// A path in one form, whether there is a file or not.
fn place(path: &Path) -> PathBuf {
    if let Ok(whole) = path.canonicalize() {
        return whole;
    }
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    if let (Ok(false), Ok(target)) = (path.try_exists(), path.read_link()) {
        return place(&directory.join(target));
    }
    match (directory.canonicalize(), path.file_name()) {
        (Ok(directory), Some(name)) => directory.join(name),
        _ => path.to_owned(),
    }
}

/// A picture and, if wanted, its table.
#[derive(Debug)]
pub(crate) struct Drawing<'a> {
    plot: &'a Path,
    csv: Option<&'a Path>,
    files: Option<(Output, Option<Output>)>,
}

impl<'a> Drawing<'a> {
    /// # Errors
    /// As [`apart`]; [`Fault::Write`] if a file is to be in a directory that is not there.
    pub(crate) fn new(plot: &'a Path, csv: Option<&'a Path>) -> Result<Self, Fault> {
        apart(&[("--plot", Some(plot)), ("--csv", csv), printed()])?;
        for path in [Some(plot), csv].into_iter().flatten() {
            let directory = path
                .parent()
                .filter(|parent| !parent.as_os_str().is_empty());
            if let Some(Err(source)) = directory.map(std::fs::metadata) {
                return Err(unwritten(path, source));
            }
        }
        let files = None;
        Ok(Drawing { plot, csv, files })
    }

    /// Makes the files, once: when the first part of the work is done, so that bad input leaves them alone.
    pub(crate) fn create(&mut self) -> Result<(), Fault> {
        if self.files.is_none() {
            let csv = self.csv.map(Output::open).transpose()?;
            self.files = Some((Output::open(self.plot)?, csv));
        }
        Ok(())
    }

    pub(crate) fn write(mut self, plot: &str, csv: impl FnOnce() -> String) -> Result<(), Fault> {
        self.create()?;
        if let Some((plot_file, csv_file)) = self.files {
            plot_file.write(plot)?;
            csv_file.map_or(Ok(()), |file| file.write(&csv()))?;
        }
        Ok(())
    }
}

/// A file opened before the work: a path that cannot be written is worth knowing at once. What is in it stays
/// until there is something to write.
#[derive(Debug)]
pub(crate) struct Output {
    path: PathBuf,
    file: File,
}

impl Output {
    pub(crate) fn open(path: &Path) -> Result<Self, Fault> {
        let file = lock::open(path)?;
        let path = path.to_owned();
        Ok(Output { path, file })
    }

    pub(crate) fn write(mut self, text: &str) -> Result<(), Fault> {
        let written = lock::empty(&self.file).and_then(|()| self.file.write_all(text.as_bytes()));
        written.map_err(|source| unwritten(&self.path, source))
    }
}
