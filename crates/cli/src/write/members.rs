//! The file of an ensemble: its options, and a row of comma-separated values for every member made.
//!
//! The first line is `# equip ensemble`, the version of the format, and the options as JSON: all that the
//! bits of the rows depend on. The second has the names of the columns, of which the last is a checksum of
//! the options, whatever the shard, and the row: what was changed is refused. Rows stand in the order in
//! which they were finished until all are there; then the file is written anew in the order of the members,
//! beside the old one, whose name it takes.

use crate::args::Shard;
use crate::fault::Fault;
use crate::write::checkpoint::unfinished;
use crate::write::checksum::{checksum, continued};
use crate::write::csv::digits;
use crate::write::lock::{self, unwritten};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// What the first line begins with.
const NAME: &str = "# equip ensemble 2 ";

/// All that the rows of an ensemble depend on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Head {
    /// Version of the program.
    pub(crate) version: String,
    pub(crate) scene: String,
    pub(crate) parameters: Vec<(String, String)>,
    pub(crate) n: u64,
    pub(crate) seed: u64,
    pub(crate) spread: f64,
    pub(crate) method: String,
    pub(crate) stages: usize,
    pub(crate) step: Option<f64>,
    pub(crate) tolerance: Option<f64>,
    pub(crate) until: f64,
    /// Degrees of freedom.
    pub(crate) m: usize,
    /// Which share of the members, from 1, and of how many.
    pub(crate) shard: (u64, u64),
}

impl Head {
    /// Numbers of the members of the shard.
    pub(crate) fn members(&self) -> Range<u64> {
        let (number, count) = self.shard;
        let border = |k: u64| (u128::from(self.n) * u128::from(k) / u128::from(count)) as u64;
        border(number - 1)..border(number)
    }

    /// The same ensemble as one shard of one.
    pub(crate) fn whole(&self) -> Self {
        let shard = (1, 1);
        Head {
            shard,
            ..self.clone()
        }
    }

    /// The first option in which `self` differs from `other`, with both values.
    pub(crate) fn difference(&self, other: &Head) -> Option<(String, String, String)> {
        let values = [self, other].map(|head| serde_json::to_value(head).unwrap_or(Value::Null));
        let [Value::Object(ours), Value::Object(theirs)] = &values else {
            return None;
        };
        let differs = |(name, value): &(&String, &Value)| theirs.get(*name) != Some(value);
        let (name, value) = ours.iter().find(differs)?;
        let theirs = theirs.get(name).unwrap_or(&Value::Null);
        if name == "parameters" {
            let mut pairs = self.parameters.iter().zip(&other.parameters);
            if let Some((ours, theirs)) = pairs.find(|(ours, theirs)| ours != theirs) {
                return Some((ours.0.clone(), ours.1.clone(), theirs.1.clone()));
            }
        }
        let word = |value: &Value| match value {
            Value::String(text) => text.clone(),
            Value::Null => "none".to_owned(),
            Value::Array(pair) => pair
                .iter()
                .map(Value::to_string)
                .collect::<Vec<_>>()
                .join("/"),
            other => other.to_string(),
        };
        Some((name.clone(), word(value), word(theirs)))
    }

    /// The two lines before the rows.
    fn text(&self) -> Result<String, std::io::Error> {
        let mut text = format!("{NAME}{}\nmember", serde_json::to_string(self)?);
        let mut columns = |end: &str| {
            for name in ["q", "p"] {
                for i in 1..=self.m {
                    // Writing to a String does not fail.
                    let _ = write!(text, ",{name}{i}{end}");
                }
            }
            if end == "_start" {
                text += ",t";
            }
        };
        columns("_start");
        columns("");
        text += ",energy_defect,steps,energy_kept,error,checksum\n";
        Ok(text)
    }
}

/// The checksum that those of the rows go on from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seal(u64);

impl Seal {
    /// # Errors
    /// If the options cannot be written as text.
    pub(crate) fn of(head: &Head) -> std::io::Result<Self> {
        Ok(Seal(checksum(head.whole().text()?.as_bytes())))
    }

    /// The row with its checksum and the end of its line.
    fn close(self, row: &str) -> String {
        format!("{row},{:016x}\n", continued(self.0, row.as_bytes()))
    }

    /// Whether a line is as it was written.
    fn is_whole(self, line: &str) -> bool {
        let row = line.rsplit_once(',').map(|(row, _)| self.close(row));
        row.as_deref() == Some(line)
    }
}

/// One member.
pub(crate) struct Row<'a> {
    pub(crate) member: u64,
    pub(crate) start: (&'a [f64], &'a [f64]),
    pub(crate) t: f64,
    pub(crate) end: (&'a [f64], &'a [f64]),
    pub(crate) energy_defect: f64,
    pub(crate) steps: u64,
    pub(crate) energy_kept: bool,
    pub(crate) error: &'a str,
}

impl Row<'_> {
    /// The row as a line, its end included.
    pub(crate) fn text(&self, seal: Seal) -> String {
        let mut text = self.member.to_string();
        let mut put = |x: f64| {
            text.push(',');
            text += &digits(x);
        };
        self.start.0.iter().for_each(|&x| put(x));
        self.start.1.iter().for_each(|&x| put(x));
        put(self.t);
        self.end.0.iter().for_each(|&x| put(x));
        self.end.1.iter().for_each(|&x| put(x));
        put(self.energy_defect);
        let error = self.error.replace('"', "\"\"").replace('\n', " ");
        let _ = write!(text, ",{},{},\"{error}\"", self.steps, self.energy_kept);
        seal.close(&text)
    }
}

/// What a file holds: its options, and its whole rows by the numbers of their members, each with the end of
/// its line.
#[derive(Debug)]
pub(crate) struct Members {
    pub(crate) head: Head,
    pub(crate) rows: BTreeMap<u64, String>,
    /// Length of the file up to the last whole row.
    bytes: u64,
}

impl Members {
    /// Numbers of the members of the shard that are not there.
    pub(crate) fn missing(&self) -> Vec<u64> {
        let is_missing = |member: &u64| !self.rows.contains_key(member);
        self.head.members().filter(is_missing).collect()
    }
}

/// The ensemble in the file `path`, read from `file`.
///
/// # Errors
/// If the file cannot be read, or is not that of an ensemble.
pub(crate) fn read(path: &Path, file: &mut File) -> Result<Members, Fault> {
    let path = || path.to_owned();
    let mut bytes = Vec::new();
    (file.read_to_end(&mut bytes)).map_err(|source| Fault::Read {
        path: path(),
        source,
    })?;
    parse(&String::from_utf8_lossy(&bytes))
        .map_err(|what| Fault::NotAnEnsemble { path: path(), what })
}

fn parse(text: &str) -> Result<Members, String> {
    let no_head = || String::from("its first line is not that of one of this version");
    let head = text
        .strip_prefix(NAME)
        .and_then(|rest| rest.split_once('\n'));
    let (head, _) = head.ok_or_else(no_head)?;
    let head: Head = serde_json::from_str(head).map_err(|_| no_head())?;
    let (number, count) = head.shard;
    if !(1..=count).contains(&number) {
        return Err(format!("it is shard {number} of {count}"));
    }
    let before = head.text().map_err(|_| no_head())?;
    let Some(lines) = text.strip_prefix(&before) else {
        return Err("its second line has not the names of its columns".into());
    };
    // A row without an end was being written when the program was killed.
    let whole = lines.rfind('\n').map_or(0, |at| at + 1);
    let seal = Seal::of(&head).map_err(|_| no_head())?;
    let mut rows = BTreeMap::new();
    for line in lines[..whole].split_inclusive('\n') {
        if !seal.is_whole(line) {
            return Err(format!(
                "the row that begins with {} is not as it was written, by its checksum; without that line it is made again",
                line.chars().take(40).collect::<String>().trim_end()
            ));
        }
        let member = line.split(',').next().and_then(|cell| cell.parse().ok());
        let Some(member) = member.filter(|member| head.members().contains(member)) else {
            return Err(format!(
                "there is a row of no member of it: {}",
                line.trim_end()
            ));
        };
        rows.insert(member, line.to_owned());
    }
    Ok(Members {
        head,
        rows,
        bytes: (before.len() + whole) as u64,
    })
}

/// A file to which rows are added as they are finished.
#[derive(Debug)]
pub(crate) struct Growing {
    path: PathBuf,
    file: File,
}

impl Growing {
    /// Opens the file of the ensemble, locked, and reads what is in it; it is made if it is not there.
    ///
    /// # Errors
    /// If it is not the file of this shard of this ensemble, or another program writes it.
    pub(crate) fn open(path: &Path, head: &Head) -> Result<(Self, Members), Fault> {
        let mut file = lock::reopen_or_make(path)?;
        let fault = |source| unwritten(path, source);
        // One that was killed before its first line has nothing in its file.
        let found = if file.metadata().map_err(fault)?.len() > 0 {
            let found = read(path, &mut file)?;
            if let Some((what, stored, now)) = found.head.difference(head) {
                return Err(Fault::OtherEnsemble {
                    path: path.to_owned(),
                    what,
                    stored,
                    now,
                });
            }
            file.set_len(found.bytes).map_err(fault)?;
            file.seek(SeekFrom::End(0)).map_err(fault)?;
            found
        } else {
            let text = head.text().map_err(fault)?;
            file.write_all(text.as_bytes()).map_err(fault)?;
            Members {
                head: head.clone(),
                rows: BTreeMap::new(),
                bytes: text.len() as u64,
            }
        };
        let path = path.to_owned();
        Ok((Growing { path, file }, found))
    }

    /// Adds a row: from here on it outlives the program.
    pub(crate) fn add(&mut self, row: &str) -> Result<(), Fault> {
        let added = self.file.write_all(row.as_bytes());
        added.map_err(|source| unwritten(&self.path, source))
    }

    /// Brings what was written to the disk.
    pub(crate) fn sync(&self) -> Result<(), Fault> {
        let synced = self.file.sync_data();
        synced.map_err(|source| unwritten(&self.path, source))
    }
}

/// Writes all rows in their order, to a file beside `path` that then takes its name.
pub(crate) fn write<'a>(
    path: &Path,
    head: &Head,
    rows: impl Iterator<Item = &'a String>,
) -> Result<(), Fault> {
    let beside = unfinished(path);
    let file = lock::create(&beside)?;
    let written = || {
        let mut out = BufWriter::new(file);
        out.write_all(head.text()?.as_bytes())?;
        for row in rows {
            out.write_all(row.as_bytes())?;
        }
        out.flush()?;
        out.get_ref().sync_all()?;
        std::fs::rename(&beside, path)
    };
    written().map_err(|source| unwritten(path, source))
}

impl From<Shard> for (u64, u64) {
    fn from(shard: Shard) -> Self {
        (shard.number, shard.count)
    }
}

#[cfg(test)]
mod tests {
    use super::{Head, Seal, parse};

    fn head(n: u64, shard: (u64, u64)) -> Head {
        Head {
            version: "1".into(),
            scene: "pendulum".into(),
            parameters: vec![],
            n,
            seed: 0,
            spread: 0.1,
            method: "equip".into(),
            stages: 4,
            step: Some(0.1),
            tolerance: None,
            until: 1.0,
            m: 1,
            shard,
        }
    }

    #[test]
    fn shards_cover_all_members_once() {
        for (n, count) in [(10, 3), (2, 5), (1, 1), (97, 8), (u64::from(u32::MAX), 7)] {
            let all: Vec<_> = (1..=count).map(|k| head(n, (k, count)).members()).collect();
            assert_eq!((all[0].start, all[all.len() - 1].end), (0, n));
            assert!(all.windows(2).all(|pair| pair[0].end == pair[1].start));
        }
    }

    #[test]
    fn half_rows_do_not_count_and_strange_ones_are_refused() {
        let before = head(4, (2, 2)).text().unwrap();
        let seal = Seal::of(&head(4, (2, 2))).unwrap();
        let row = seal.close("3,whole");
        let found = parse(&format!("{before}{row}2,hal")).unwrap();
        assert_eq!(found.missing(), [2]);
        assert_eq!(found.bytes as usize, before.len() + row.len());
        for wrong in ["1,of another shard", "4,none", "x"] {
            assert!(parse(&format!("{before}{}", seal.close(wrong))).is_err());
        }
        for place in 0..row.len() - 1 {
            let mut bytes = row.clone().into_bytes();
            bytes[place] ^= 1;
            let changed = String::from_utf8(bytes).unwrap();
            assert!(parse(&format!("{before}{changed}")).is_err(), "{changed}");
        }
        // The options belong to every row, the shard does not.
        let mut other = head(4, (2, 2));
        other.seed = 1;
        assert!(parse(&format!("{}{row}", other.text().unwrap())).is_err());
        let whole = head(4, (1, 1)).text().unwrap();
        assert!(parse(&format!("{whole}{row}")).is_ok());
        assert!(parse("member,q1\n").is_err() && parse("").is_err());
    }
}
