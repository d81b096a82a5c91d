//! The table as one page that needs nothing else: colours by verdict, readable by light and dark.

use super::measure::Row;
use super::outcomes::{LEGEND, outcomes};
use super::summary::Summary;
use crate::draw::page::{Cell, Table, cell, page};
use crate::draw::svg::escape;

pub(crate) fn document(rows: &[Row<'_>], summary: &Summary) -> String {
    let mut table = Table::default();
    let mut theme = "";
    for row in rows {
        let cells = cells(row);
        if row.case.theme != theme {
            theme = row.case.theme;
            table.push_heading("theme", cells.len(), theme);
        }
        let word = row.verdict.word.label().to_lowercase();
        let class = word.split(' ').next().unwrap_or_default();
        table.push(&format!(" class=\"{class}\""), &cells);
    }
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
         {known_deficits} known deficits, <b>{failed} fail</b>; {seconds:.1} s</p>\n<p><small>{legend}</small></p>\n{table}",
        version = env!("CARGO_PKG_VERSION"),
        table = table.html("rows"),
    );
    page("equip check", &body)
}

fn cells(row: &Row<'_>) -> Vec<Cell> {
    let m = &row.measured;
    let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:.1e}"));
    let plain = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:.3}"));
    let notes = escape(&row.verdict.notes.join("; "));
    let verdict = format!("<b>{}</b> <small>{notes}</small>", row.verdict.word.label());
    vec![
        cell("case", escape(&row.case.name)),
        cell("setting", escape(&row.case.setting())),
        cell("steps", m.equip.counts.steps.to_string()),
        cell("outcomes", outcomes(&m.equip, "&nbsp;")),
        cell("levels", plain(m.levels())),
        cell("energy", number(Some(m.equip.energy))),
        cell("energy, Gauss", number(Some(m.gauss.energy))),
        cell("invariants", number(m.worst_invariant().map(|i| i.error))),
        cell("error", number(m.error)),
        cell("error, Gauss", number(m.gauss_error)),
        cell("ratio", plain(m.ratio())),
        cell("seconds", format!("{:.2}", row.all_seconds)),
        cell("verdict", verdict),
    ]
}
