//! [`Rows`]: the steps of a run as a table of comma-separated values.
//!
//! One header row `t,q1,…,qm,p1,…,pm,energy_defect,outcome`, then one row per step kept. Numbers have as many digits
//! as read back to the same number; all are in the units of the scene. The energy defect is H − H_ref. Where a deviation is followed there are two more
//! columns, `lyapunov,megno`, empty in the first row.

use equip_integrate::ChaosIndicators;
use equip_scalar::Float;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

/// The word in the outcome column of the initial state, which no step made.
const START: &str = "start";

#[derive(Debug)]
pub(crate) struct Rows<W: Write> {
    out: W,
    every: u64,
    last: Option<u64>,
    with_chaos: bool,
}

/// One row of the table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row<'a, T> {
    pub(crate) index: u64,
    pub(crate) time: T,
    pub(crate) q: &'a [T],
    pub(crate) p: &'a [T],
    pub(crate) energy_defect: Option<T>,
    pub(crate) outcome: &'a str,
    pub(crate) chaos: Option<ChaosIndicators<T>>,
}

impl Rows<BufWriter<File>> {
    /// Goes on with the table in `path` after step number `index` at `time`; rows after it were made by steps that are made again.
    pub(crate) fn go_on<T: Float>(
        path: &Path,
        every: u64,
        (index, time): (u64, T),
        with_chaos: bool,
    ) -> io::Result<Self> {
        let text = std::fs::read_to_string(path)?;
        let mut length = 0;
        for line in text.split_inclusive('\n') {
            let first = line.split(',').next().unwrap_or_default();
            // The last row of an interrupted run is there whatever its number.
            let wanted = index.is_multiple_of(every);
            let later = T::decimal(first).is_ok_and(|t| t > time || (t == time && !wanted));
            if later || !line.ends_with('\n') {
                break;
            }
            length += line.len();
        }
        let mut file = OpenOptions::new().write(true).open(path)?;
        file.set_len(length as u64)?;
        file.seek(SeekFrom::End(0))?;
        Ok(Rows {
            out: BufWriter::new(file),
            every,
            last: None,
            with_chaos,
        })
    }
}

impl<W: Write> Rows<W> {
    pub(crate) fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }

    /// Writes the header and the initial state.
    pub(crate) fn start<T: Float>(
        mut out: W,
        every: u64,
        (q, p): (&[T], &[T]),
        with_chaos: bool,
    ) -> io::Result<Self> {
        write!(out, "t")?;
        for name in ["q", "p"] {
            for i in 1..=q.len() {
                write!(out, ",{name}{i}")?;
            }
        }
        let more = if with_chaos { ",lyapunov,megno" } else { "" };
        writeln!(out, ",energy_defect,outcome{more}")?;
        let mut rows = Rows {
            out,
            every,
            last: None,
            with_chaos,
        };
        let zero = T::int(0);
        rows.write(Row {
            index: 0,
            time: zero,
            q,
            p,
            energy_defect: Some(zero),
            outcome: START,
            chaos: None,
        })?;
        Ok(rows)
    }

    /// Writes the row if it is one of those wanted.
    pub(crate) fn step<T: Float>(&mut self, row: Row<'_, T>) -> io::Result<()> {
        if row.index.is_multiple_of(self.every) {
            self.write(row)
        } else {
            Ok(())
        }
    }

    /// Writes the last row, whatever its number, and flushes.
    pub(crate) fn finish<T: Float>(mut self, last: Row<'_, T>) -> io::Result<()> {
        if self.last != Some(last.index) {
            self.write(last)?;
        }
        self.out.flush()
    }

    fn write<T: Float>(&mut self, row: Row<'_, T>) -> io::Result<()> {
        write!(self.out, "{}", digits(row.time))?;
        for &x in row.q.iter().chain(row.p) {
            write!(self.out, ",{}", digits(x))?;
        }
        match row.energy_defect {
            Some(defect) => write!(self.out, ",{}", digits(defect))?,
            None => write!(self.out, ",")?,
        }
        // Labels may hold a comma.
        write!(self.out, ",\"{}\"", row.outcome)?;
        match row.chaos {
            Some(chaos) => {
                let [lyapunov, megno] = [chaos.lyapunov, chaos.megno].map(digits);
                write!(self.out, ",{lyapunov},{megno}")?;
            }
            None if self.with_chaos => write!(self.out, ",,")?,
            None => {}
        }
        writeln!(self.out)?;
        self.last = Some(row.index);
        Ok(())
    }
}

/// A number with all the digits it takes to read it back. A double-double whose low part happens to vanish or to be
/// tiny takes more than its 33.
pub(crate) fn digits<T: Float>(x: T) -> String {
    let shortest = format!("{x:e}");
    match T::decimal(&shortest) {
        Ok(back) if back == x => shortest,
        _ => format!("{x:.0$e}", T::ROUND_TRIP_DIGITS - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::{Row, Rows, digits};
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
        let mut file = Vec::new();
        let row = |index| Row {
            index,
            time: index as f64,
            q: &[0.5],
            p: &[2.0],
            energy_defect: None,
            outcome: "a, b",
            chaos: None,
        };
        let mut rows = Rows::start(&mut file, 2, (&[0.5], &[2.0]), false).unwrap();
        for index in 1..=3 {
            rows.step(row(index)).unwrap();
        }
        rows.finish(row(3)).unwrap();
        let text = String::from_utf8(file).unwrap();
        let expected = "t,q1,p1,energy_defect,outcome\n0e0,5e-1,2e0,0e0,\"start\"\n2e0,5e-1,2e0,,\"a, b\"\n3e0,5e-1,2e0,,\"a, b\"\n";
        assert_eq!(text, expected);
    }
}
