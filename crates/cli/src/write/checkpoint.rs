//! The file of a checkpoint: the run, what it belongs to, how far its table is and what its picture has of
//! it.
//!
//! The first line has the version of the format and a checksum of all behind it, which is JSON. A checkpoint
//! is written to a file of its own beside the one asked for and then takes its name: whenever the program
//! ends, the file is a whole checkpoint, the last or the one before it.

use crate::args::number;
use crate::draw::samples::Picture;
use crate::fault::Fault;
use crate::write::csv::Mark;
use crate::write::lock::unwritten;
use equip_integrate::Checkpoint;
use equip_scalar::DoubleDouble;
use equip_scenes::Instance;
use fnv::FnvHasher;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::hash::Hasher;
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What the first line begins with.
const NAME: &str = "equip checkpoint";
/// The version of what is behind the first line.
const VERSION: &str = "2";

/// What the file holds.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Saved {
    scene: String,
    /// Names and values, as text.
    parameters: Vec<(String, String)>,
    /// Of the table, if the run writes one.
    pub(crate) table: Option<Mark>,
    /// Of the picture, if the run draws one.
    pub(crate) picture: Option<Picture>,
    pub(crate) checkpoint: Checkpoint,
}

impl Saved {
    /// Whether this is a checkpoint of the scene with these parameters.
    ///
    /// # Errors
    /// [`Fault::OtherRun`], with both values.
    pub(crate) fn check(&self, path: &Path, instance: &Instance) -> Result<(), Fault> {
        let differ = |what: &str, stored: &str, now: &str| Fault::OtherRun {
            path: path.to_owned(),
            what: what.to_owned(),
            stored: stored.to_owned(),
            now: now.to_owned(),
        };
        let scene = instance.scene().name;
        if self.scene != scene {
            return Err(differ("scene", &self.scene, scene));
        }
        for ((name, stored), (_, now)) in self.parameters.iter().zip(instance.parameters()) {
            let value = |text: &str| number::<DoubleDouble>("", text).ok();
            if stored != now && value(stored) != value(now) {
                return Err(differ(name, stored, now));
            }
        }
        Ok(())
    }

    fn write(&self, path: &Path) -> io::Result<()> {
        let text = serde_json::to_string(self)?;
        let mut file = File::create(path)?;
        let checksum = checksum(text.as_bytes());
        writeln!(file, "{NAME} {VERSION} {checksum:016x}")?;
        file.write_all(text.as_bytes())?;
        file.sync_all()
    }
}

/// When and where checkpoints are written.
#[derive(Debug)]
pub(crate) struct Saver {
    path: PathBuf,
    every: Duration,
    last: Instant,
    scene: &'static str,
    parameters: Vec<(String, String)>,
}

impl Saver {
    pub(crate) fn new(path: &Path, every: Duration, instance: &Instance) -> Self {
        let text = |(name, value): (&str, &str)| (name.to_owned(), value.to_owned());
        Saver {
            path: path.to_owned(),
            every,
            last: Instant::now(),
            scene: instance.scene().name,
            parameters: instance.parameters().map(text).collect(),
        }
    }

    /// Whether the last checkpoint is old enough.
    pub(crate) fn is_due(&self) -> bool {
        self.last.elapsed() >= self.every
    }

    pub(crate) fn save(
        &mut self,
        checkpoint: Checkpoint,
        table: Option<Mark>,
        picture: Option<Picture>,
    ) -> Result<(), Fault> {
        let saved = Saved {
            scene: self.scene.to_owned(),
            parameters: self.parameters.clone(),
            table,
            picture,
            checkpoint,
        };
        let new = unfinished(&self.path);
        let written = saved.write(&new);
        let written = written.and_then(|()| std::fs::rename(&new, &self.path));
        self.last = Instant::now();
        written.map_err(|source| {
            // Part of a checkpoint is of no use.
            let _ = std::fs::remove_file(&new);
            unwritten(&self.path, source)
        })
    }
}

fn checksum(bytes: &[u8]) -> u64 {
    let mut sum = FnvHasher::default();
    sum.write(bytes);
    sum.finish()
}

/// The file that a checkpoint is written to before it takes its name.
pub(crate) fn unfinished(path: &Path) -> PathBuf {
    let mut name = path.to_owned().into_os_string();
    name.push(".new");
    PathBuf::from(name)
}

/// The checkpoint in a file; `None` if there is no such file.
///
/// # Errors
/// If the file cannot be read, is no checkpoint, or has been changed since it was written.
pub(crate) fn load(path: &Path) -> Result<Option<Saved>, Fault> {
    let read = |source| Fault::Read {
        path: path.to_owned(),
        source,
    };
    let not_one = |what| Fault::NotACheckpoint {
        path: path.to_owned(),
        what,
    };
    let mut file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(read(error)),
    };
    let mut bytes = Vec::new();
    // Of a file that is something else, of any size, no more than this is read.
    let mut head = (&file).take(NAME.len() as u64);
    head.read_to_end(&mut bytes).map_err(read)?;
    if bytes != NAME.as_bytes() {
        return Err(not_one(OTHER_FILE));
    }
    if file.metadata().map_err(read)?.len() > LARGEST {
        return Err(not_one("it is larger than 1 GiB"));
    }
    file.read_to_end(&mut bytes).map_err(read)?;
    parse(&bytes).map(Some).map_err(not_one)
}

/// Bytes of a file that are read at most, far more than any scene needs.
const LARGEST: u64 = 1 << 30;
/// What is wrong with a file that is something else.
const OTHER_FILE: &str = "its first line is not that of a checkpoint";

fn parse(bytes: &[u8]) -> Result<Saved, &'static str> {
    let split = bytes.iter().position(|&byte| byte == b'\n');
    let (first, text) = bytes.split_at(split.unwrap_or(0));
    let text = text.get(1..).unwrap_or_default();
    let first = std::str::from_utf8(first).unwrap_or_default();
    let (version, stored) = first
        .strip_prefix(NAME)
        .and_then(|rest| rest.trim_start().split_once(' '))
        .ok_or(OTHER_FILE)?;
    if version != VERSION {
        return Err("another version of the program wrote it");
    }
    if stored != format!("{:016x}", checksum(text)) {
        return Err("its checksum does not match its content");
    }
    serde_json::from_slice(text).map_err(|_| "its content is not a run")
}
