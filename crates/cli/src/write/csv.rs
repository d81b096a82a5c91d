//! [`Rows`]: the steps of a run as a table of comma-separated values.
//!
//! One header row `t,q1,…,qm,p1,…,pm,energy_error,outcome`, then one row per step kept. Numbers have as many
//! digits as read back to the same number; all are in the units of the scene. The energy error is H − H_ref.
//! Where a tangent vector is followed there are two more columns, `lyapunov,megno`, empty in the first row.

use crate::fault::Fault;
use crate::write::lock;
use equip_integrate::ChaosIndicators;
use equip_scalar::Float;
use fnv::FnvHasher;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::fs::File;
use std::hash::Hasher;
use std::io::{self, BufRead, BufReader, BufWriter, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// The word in the outcome column of the initial state, which no step made.
const START: &str = "start";

/// A table that is being written.
#[derive(Debug)]
pub(crate) struct Rows {
    out: BufWriter<File>,
    mark: Mark,
}

/// How far a table is written: what a checkpoint keeps of it, and by what the table is known again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Mark {
    header: String,
    /// Every how many steps there is a row.
    every: u64,
    /// Number of the step of the last row.
    index: u64,
    last_row: String,
    /// Length of the file, and the checksum of all of it.
    bytes: u64,
    checksum: u64,
}

impl Mark {
    /// That of a table of which nothing is written.
    pub(crate) fn new(degrees_of_freedom: usize, every: u64, with_chaos: bool) -> Self {
        let mut header = String::from("t");
        for name in ["q", "p"] {
            for i in 1..=degrees_of_freedom {
                // Writing to a String does not fail.
                let _ = write!(header, ",{name}{i}");
            }
        }
        header += ",energy_error,outcome";
        if with_chaos {
            header += ",lyapunov,megno";
        }
        Mark {
            header,
            every,
            index: 0,
            last_row: String::new(),
            bytes: 0,
            checksum: FnvHasher::default().finish(),
        }
    }

    /// Opens the table in `path`, locked, if it is the one that was written up to this mark, by one that is
    /// `wanted`.
    ///
    /// # Errors
    /// [`Fault::Table`], with what is missing; [`Fault::InUse`].
    pub(crate) fn open(&self, path: &Path, wanted: &Mark) -> Result<File, Fault> {
        let wrong = |what: String| Fault::Table {
            path: path.to_owned(),
            what,
        };
        let io = |source: io::Error| match source.kind() {
            ErrorKind::NotFound => wrong("it does not exist".into()),
            _ => Fault::Read {
                path: path.to_owned(),
                source,
            },
        };
        if self.every != wanted.every {
            let (before, now) = (self.every, wanted.every);
            return Err(wrong(format!(
                "it was written with --every {before}, not {now}"
            )));
        }
        let mut file = lock::reopen(path).map_err(|fault| match fault {
            Fault::Write { source, .. } => io(source),
            other => other,
        })?;
        let length = file.metadata().map_err(io)?.len();
        let read = |file: &mut File, from: u64, count: usize| {
            let mut text = vec![0; count];
            file.seek(SeekFrom::Start(from))?;
            file.read_exact(&mut text)?;
            Ok(String::from_utf8_lossy(&text).into_owned())
        };
        let time = |row: &str| row.split(',').next().unwrap_or_default().to_owned();
        if length < self.bytes {
            let count = length.min(LONGEST_TAIL);
            let tail = read(&mut file, length - count, count as usize).map_err(io)?;
            let whole = tail.rsplit_once('\n').map_or("", |(whole, _)| whole);
            let reached = whole.rsplit('\n').next().map(time).unwrap_or_default();
            return Err(wrong(format!(
                "its last complete row is at t = {reached}, but the run had written it up to t = {}",
                time(&self.last_row)
            )));
        }
        let header = read(&mut file, 0, self.header.len().min(length as usize)).map_err(io)?;
        if header != wanted.header || self.header != wanted.header {
            return Err(wrong(format!("its columns are not {}", wanted.header)));
        }
        let count = self.last_row.len();
        let row = read(&mut file, self.bytes.saturating_sub(count as u64), count).map_err(io)?;
        if row != self.last_row {
            return Err(wrong(format!(
                "it belongs to another run: its row at t = {} is not the row that was written",
                time(&self.last_row)
            )));
        }
        file.seek(SeekFrom::Start(0)).map_err(io)?;
        if checksum_of(&mut file, self.bytes).map_err(io)? != self.checksum {
            return Err(wrong(format!(
                "a row up to t = {} has changed since it was written",
                time(&self.last_row)
            )));
        }
        Ok(file)
    }
}

/// The checksum of the next `count` bytes.
fn checksum_of(file: &mut File, count: u64) -> io::Result<u64> {
    let mut reader = BufReader::new(file.take(count));
    let mut sum = FnvHasher::default();
    loop {
        let bytes = reader.fill_buf()?;
        let length = bytes.len();
        if length == 0 {
            return Ok(sum.finish());
        }
        sum.write(bytes);
        reader.consume(length);
    }
}

/// How much of the end of a table that is too short is read to tell its last row.
const LONGEST_TAIL: u64 = 1 << 16;

/// One row of the table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row<'a, T> {
    pub(crate) index: u64,
    pub(crate) time: T,
    pub(crate) q: &'a [T],
    pub(crate) p: &'a [T],
    pub(crate) energy_error: Option<T>,
    pub(crate) outcome: &'a str,
    pub(crate) chaos: Option<ChaosIndicators<T>>,
}

impl Rows {
    /// Writes the header and the initial state to an empty file.
    pub(crate) fn start<T: Float>(
        file: File,
        mark: Mark,
        (q, p): (&[T], &[T]),
    ) -> io::Result<Self> {
        let out = BufWriter::new(file);
        let mut rows = Rows { out, mark };
        let header = format!("{}\n", rows.mark.header);
        rows.put(header)?;
        let zero = T::int(0);
        rows.write(Row {
            index: 0,
            time: zero,
            q,
            p,
            energy_error: Some(zero),
            outcome: START,
            chaos: None,
        })?;
        Ok(rows)
    }

    /// Goes on with a table from the mark that opened it; rows behind it were made by steps that are made
    /// again.
    pub(crate) fn go_on(mut file: File, mark: Mark) -> io::Result<Self> {
        if file.metadata()?.len() != mark.bytes {
            file.set_len(mark.bytes)?;
        }
        file.seek(SeekFrom::End(0))?;
        let out = BufWriter::new(file);
        Ok(Rows { out, mark })
    }

    /// Brings all rows to the disk, and says how far the table is.
    pub(crate) fn sync(&mut self) -> io::Result<Mark> {
        self.out.flush()?;
        self.out.get_ref().sync_data()?;
        Ok(self.mark.clone())
    }

    /// Writes the row if it is one of those wanted, or the last.
    pub(crate) fn step<T: Float>(&mut self, row: Row<'_, T>, is_last: bool) -> io::Result<()> {
        if is_last || row.index.is_multiple_of(self.mark.every) {
            self.write(row)
        } else {
            Ok(())
        }
    }

    /// Writes the last row, whatever its number, and flushes.
    pub(crate) fn finish<T: Float>(mut self, last: Row<'_, T>) -> io::Result<()> {
        if self.mark.index != last.index {
            self.write(last)?;
        }
        self.out.flush()
    }

    fn write<T: Float>(&mut self, row: Row<'_, T>) -> io::Result<()> {
        let mut text = std::mem::take(&mut self.mark.last_row);
        text.clear();
        text += &digits(row.time);
        for &x in row.q.iter().chain(row.p) {
            text.push(',');
            text += &digits(x);
        }
        text.push(',');
        if let Some(energy_error) = row.energy_error {
            text += &digits(energy_error);
        }
        // Labels may hold a comma. Writing to a String does not fail.
        let _ = write!(text, ",\"{}\"", row.outcome);
        match row.chaos {
            Some(chaos) => {
                let [lyapunov, megno] = [chaos.lyapunov, chaos.megno].map(digits);
                let _ = write!(text, ",{lyapunov},{megno}");
            }
            None if self.mark.header.ends_with("megno") => text.push_str(",,"),
            None => {}
        }
        text.push('\n');
        self.mark.index = row.index;
        self.put(text)
    }

    fn put(&mut self, text: String) -> io::Result<()> {
        self.out.write_all(text.as_bytes())?;
        self.mark.bytes += text.len() as u64;
        let mut sum = FnvHasher::with_key(self.mark.checksum);
        sum.write(text.as_bytes());
        self.mark.checksum = sum.finish();
        self.mark.last_row = text;
        Ok(())
    }
}

/// A number with all the digits it takes to read it back. A double-double whose low part happens to vanish or
/// to be tiny takes more than its 33.
pub(crate) fn digits<T: Float>(x: T) -> String {
    let shortest = format!("{x:e}");
    match T::decimal(&shortest) {
        Ok(back) if back == x => shortest,
        _ => format!("{x:.0$e}", T::ROUND_TRIP_DIGITS - 1),
    }
}

/// The cell of a number: its digits, or nothing if it is not finite.
pub(crate) fn cell(x: f64) -> String {
    match x.is_finite() {
        true => digits(x),
        false => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::{Mark, Row, Rows, digits};
    use crate::fault::Fault;
    use crate::write::lock;
    use equip_scalar::{DoubleDouble, Float};

    #[test]
    fn digits_read_back() {
        for x in [0.1, 1.0 / 3.0, -1e-300, 0.0, 6.02214076e23] {
            assert_eq!(f64::decimal(&digits(x)), Ok(x));
            let x = DoubleDouble::exact(x) / DoubleDouble::int(7);
            assert_eq!(DoubleDouble::decimal(&digits(x)), Ok(x));
        }
    }

    #[test]
    fn every_second_row_and_the_last() {
        let path = std::env::temp_dir().join(format!("equip-rows-{}.csv", std::process::id()));
        let row = |index| Row {
            index,
            time: index as f64,
            q: &[0.5],
            p: &[2.0],
            energy_error: None,
            outcome: "a, b",
            chaos: None,
        };
        let mark = Mark::new(1, 2, false);
        let mut rows =
            Rows::start(lock::open(&path).unwrap(), mark.clone(), (&[0.5], &[2.0])).unwrap();
        for index in 1..=3 {
            rows.step(row(index), false).unwrap();
        }
        let at = rows.sync().unwrap();
        rows.finish(row(3)).unwrap();
        let text = || std::fs::read_to_string(&path).unwrap();
        let expected = "t,q1,p1,energy_error,outcome\n0e0,5e-1,2e0,0e0,\"start\"\n2e0,5e-1,2e0,,\"a, b\"\n3e0,5e-1,2e0,,\"a, b\"\n";
        assert_eq!(text(), expected);
        // From the mark on the last row is written again.
        let file = at.open(&path, &mark).unwrap();
        Rows::go_on(file, at.clone())
            .unwrap()
            .finish(row(3))
            .unwrap();
        assert_eq!(text(), expected);
        // Any digit that is not as it was written is told, not only in the last row.
        for place in [8, 31, 40, 55] {
            let mut bytes = expected.as_bytes().to_vec();
            bytes[place] ^= 1;
            std::fs::write(&path, bytes).unwrap();
            assert!(
                matches!(at.open(&path, &mark), Err(Fault::Table { .. })),
                "{place}"
            );
        }
        std::fs::remove_file(&path).unwrap();
    }
}
