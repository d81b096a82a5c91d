//! The table on the terminal: two lines a row, the reason below them.

use super::case::short;
use super::measure::Row;
use super::outcomes::{LEGEND, outcomes};
use super::summary::Summary;
use super::verdict::Word;
use crate::text::wrapped;
use std::io::{self, Write};

/// Characters of the widest name that does not shift its row.
const NAME: usize = 34;
const SETTING: usize = 24;
/// A row is too wide for one line.
const INDENT: &str = "    ";

pub(crate) fn head(out: &mut impl Write, theme: &str) -> io::Result<()> {
    writeln!(out)?;
    first(out, [theme, "setting", "steps", "outcomes", "verdict"])?;
    let heads = [
        "levels", "energy", "Gauss", "inv.", "error", "Gauss", "ratio", "s",
    ];
    second(out, heads.map(str::to_owned))
}

pub(crate) fn line(out: &mut impl Write, row: &Row<'_>) -> io::Result<()> {
    let m = &row.measured;
    let number = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.1e}"));
    let plain = |x: Option<f64>| x.map_or("-".to_owned(), compact);
    let (setting, steps) = (row.case.setting(), m.equip.counts.steps.to_string());
    let (outcomes, word) = (outcomes(&m.equip, " "), row.verdict.word.label());
    first(out, [&row.case.name, &setting, &steps, &outcomes, word])?;
    let figures = [
        plain(m.levels()),
        number(Some(m.equip.energy)),
        number(Some(m.gauss.energy)),
        number(m.worst_invariant().map(|i| i.error)),
        number(m.error),
        number(m.gauss_error),
        plain(m.ratio()),
        format!("{:.2}", row.all_seconds),
    ];
    second(out, figures)?;
    notes(out, row)
}

fn first(out: &mut impl Write, cells: [&str; 5]) -> io::Result<()> {
    let [name, setting, steps, outcomes, verdict] = cells;
    writeln!(
        out,
        "{name:<NAME$} {setting:<SETTING$} {steps:>8}  {outcomes:<16} {verdict}"
    )
}

fn second(out: &mut impl Write, cells: [String; 8]) -> io::Result<()> {
    let cells = cells.map(|cell| format!("{cell:>9}"));
    writeln!(out, "{INDENT}{}", cells.join(" "))
}

fn notes(out: &mut impl Write, row: &Row<'_>) -> io::Result<()> {
    for note in &row.verdict.notes {
        writeln!(out, "{}", wrapped(INDENT, INDENT.len(), note))?;
    }
    Ok(())
}

/// A number in few characters.
fn compact(x: f64) -> String {
    if x == 0.0 || (0.01..1000.0).contains(&x) {
        format!("{x:.2}")
    } else {
        short(x)
    }
}

pub(crate) fn end(out: &mut impl Write, rows: &[Row<'_>], summary: &Summary) -> io::Result<()> {
    writeln!(out)?;
    for line in LEGEND.lines() {
        writeln!(out, "{}", wrapped("", 0, line))?;
    }
    writeln!(out)?;
    let slowest = rows
        .iter()
        .max_by(|a, b| a.all_seconds.total_cmp(&b.all_seconds));
    if let Some(row) = slowest {
        let (name, setting) = (&row.case.name, row.case.setting());
        writeln!(
            out,
            "slowest row: {name} {setting}, {:.1} s",
            row.all_seconds
        )?;
    }
    for word in [Word::Fail, Word::KnownDeficit] {
        for row in rows.iter().filter(|r| r.verdict.word == word) {
            let (name, setting) = (&row.case.name, row.case.setting());
            writeln!(out, "{} {name} {setting}", word.label())?;
            notes(out, row)?;
        }
    }
    writeln!(
        out,
        "{} rows: {} pass, {} expected errors, {} explained, {} known deficits, {} fail; {:.1} s",
        summary.rows,
        summary.passed,
        summary.expected_errors,
        summary.explained,
        summary.known_deficits,
        summary.failed,
        summary.seconds
    )
}
