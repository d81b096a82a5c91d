//! Pages that need nothing else: one style for all, on light and on dark paper.

use crate::draw::svg::{dark_style, escape};
use std::borrow::Cow;

const STYLE: &str = "
:root { color-scheme: light dark; --good: #1a7f37; --bad: #c4203a; --note: #0969da; }
@media (prefers-color-scheme: dark) { :root { --good: #4cc26a; --bad: #ff7b82; --note: #6cb6ff; } body { background: #16181c; color: #dadada; } }
body { font: 15px/1.45 system-ui, sans-serif; margin: 1.5rem auto; max-width: 1600px; padding: 0 1rem; }
body > p, body > ul { max-width: 60rem; }
h2 { margin-top: 2.5rem; } figure { margin: 1rem 0; } .legend { margin: .4rem 0; }
.legend span { display: inline-block; margin-right: 1.2rem; white-space: nowrap; } .legend svg { vertical-align: middle; }
.panels { display: flex; flex-wrap: wrap; } .panels svg { max-width: 100%; height: auto; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .15rem .7rem; text-align: left; border-bottom: 1px solid #8884; }
.numbers { white-space: nowrap; } .numbers td, .numbers th { text-align: right; }
.numbers td:first-child, .numbers th:first-child { text-align: left; }
.yes, .first { color: var(--good); font-weight: bold; } .no { color: var(--bad); font-weight: bold; }
.rows td, .rows th { text-align: right; white-space: nowrap; padding: .15rem .5rem; font-size: 13px; }
.rows :is(th, td):is(:first-child, :nth-child(2), :nth-child(4), :last-child) { text-align: left; }
.rows thead th { white-space: normal; vertical-align: bottom; } .rows td:last-child { min-width: 17rem; white-space: normal; } .rows td:first-child { min-width: 9rem; white-space: normal; }
.rows .theme th::first-letter { text-transform: uppercase; } .rows .theme th { padding-top: 1.2rem; font-size: 1.1rem; }
.pass b { color: var(--good); } .fail { background: #d1242f33; } .fail b { color: var(--bad); } .expected b, .known b { color: var(--note); }
.keeps { color: var(--note); font-weight: bold; } small, .note { color: GrayText; }
nav a { margin-right: 1rem; display: inline-block; } figcaption b { font-size: 1.15em; } figure + .wide, figure + p { margin-top: .5rem; } a { color: var(--note); } summary { cursor: pointer; margin: .6rem 0; }
";

/// A page of this title and body.
pub(crate) fn page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>{}</title>\n<style>{STYLE}{}</style>\n{body}</html>\n",
        escape(title),
        dark_style()
    )
}

/// The head of a column, and a cell of it; both are escaped already.
pub(crate) type Cell = (Cow<'static, str>, String);

/// A cell below a head that is known beforehand.
pub(crate) fn cell(head: &'static str, text: impl Into<String>) -> Cell {
    (head.into(), text.into())
}

/// A table that is made row by row; all rows have the same heads.
#[derive(Debug, Default)]
pub(crate) struct Table {
    heads: String,
    rows: String,
}

impl Table {
    /// Adds a row whose attributes are `attributes`.
    pub(crate) fn push(&mut self, attributes: &str, cells: &[Cell]) {
        self.heads = cells.iter().map(|c| format!("<th>{}</th>", c.0)).collect();
        let cells: String = cells.iter().map(|c| format!("<td>{}</td>", c.1)).collect();
        self.rows += &format!("<tr{attributes}>{cells}</tr>\n");
    }

    /// Adds a row that is one heading of `columns` columns.
    pub(crate) fn push_heading(&mut self, class: &str, columns: usize, text: &str) {
        self.rows += &format!("<tr class=\"{class}\"><th colspan=\"{columns}\">{text}</th></tr>\n");
    }

    pub(crate) fn html(&self, class: &str) -> String {
        let Table { heads, rows } = self;
        format!(
            "<div class=\"wide\"><table class=\"{class}\"><thead><tr>{heads}</tr></thead><tbody>\n{rows}</tbody></table></div>\n"
        )
    }
}

/// A table of these rows.
pub(crate) fn table(class: &str, rows: impl IntoIterator<Item = Vec<Cell>>) -> String {
    let mut table = Table::default();
    rows.into_iter().for_each(|cells| table.push("", &cells));
    table.html(class)
}
