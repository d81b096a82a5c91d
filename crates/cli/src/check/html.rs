//! The table as one page that needs nothing else: colours by verdict, readable by light and dark.

use super::measure::Row;
use super::outcomes::{LEGEND, outcomes};
use super::summary::Summary;
use super::verdict::Word;
use crate::draw::page;
use crate::draw::svg::escape;
use std::fmt::Write;

const COLUMNS: [&str; 13] = [
    "case",
    "setting",
    "steps",
    "outcomes",
    "levels",
    "energy",
    "energy, Gauss",
    "invariants",
    "error",
    "error, Gauss",
    "ratio",
    "seconds",
    "verdict",
];

pub(crate) fn document(rows: &[Row<'_>], summary: &Summary) -> String {
    let mut body = String::new();
    let mut theme = "";
    for row in rows {
        if row.case.theme != theme {
            theme = row.case.theme;
            push(
                &mut body,
                format_args!(
                    "<tr class=\"theme\"><th colspan=\"{}\">{theme}</th></tr>",
                    COLUMNS.len()
                ),
            );
        }
        push(&mut body, format_args!("{}", line(row)));
    }
    let heads: String = COLUMNS.iter().map(|c| format!("<th>{c}</th>")).collect();
    let Summary {
        rows,
        passed,
        expected_errors,
        explained,
        known_deficits,
        failed,
        seconds,
    } = summary;
    let legend = escape(LEGEND).replace('\n', "<br>");
    let body = format!(
        "<h1>equip check {version}</h1>\n\
         <p><b>{rows}</b> rows: {passed} pass, {expected_errors} expected errors, {explained} explained, \
         {known_deficits} known deficits, <b>{failed} fail</b>; {seconds:.1} s</p>\n<p><small>{legend}</small></p>\n\
         <div class=\"wide\"><table class=\"rows\">\n<thead><tr>{heads}</tr></thead>\n<tbody>\n{body}</tbody>\n</table></div>\n",
        version = env!("CARGO_PKG_VERSION"),
    );
    page::page("equip check", &body)
}

fn push(text: &mut String, line: std::fmt::Arguments<'_>) {
    // Writing to a String does not fail.
    let _ = writeln!(text, "{line}");
}

fn line(row: &Row<'_>) -> String {
    let m = &row.measured;
    let class = match row.verdict.word {
        Word::Pass => "pass",
        Word::ExpectedError => "expected",
        Word::Explained => "explained",
        Word::KnownDeficit => "known",
        Word::Fail => "fail",
    };
    let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:.1e}"));
    let plain = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:.3}"));
    let cells = [
        escape(&row.case.name),
        escape(&row.case.setting()),
        m.equip.counts.steps.to_string(),
        outcomes(&m.equip, "&nbsp;"),
        plain(m.levels()),
        number(Some(m.equip.energy)),
        number(Some(m.gauss.energy)),
        number(m.worst_invariant().map(|i| i.error)),
        number(m.error),
        number(m.gauss_error),
        plain(m.ratio()),
        format!("{:.2}", row.all_seconds),
        format!(
            "<b>{}</b> <small>{}</small>",
            row.verdict.word.label(),
            escape(&row.verdict.notes.join("; "))
        ),
    ];
    let cells: String = cells
        .iter()
        .map(|cell| format!("<td>{cell}</td>"))
        .collect();
    format!("<tr class=\"{class}\">{cells}</tr>")
}
