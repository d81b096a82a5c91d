//! Figures of a text, each with the mark behind it that says where it comes from.

use std::path::{Path, PathBuf};

const BEGIN: &str = "<!--= ";
const END: &str = " -->";

/// A figure, or a table, with where it stands in the text.
#[derive(Debug, PartialEq)]
pub(crate) struct Figure {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) command: String,
    pub(crate) place: String,
    pub(crate) limit: Limit,
    /// Whether it is measured only when asked for: its command takes minutes, or needs other programs.
    pub(crate) is_long: bool,
}

/// How near to the measured figure it must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Limit {
    Factor(f64),
    /// A table of times: it has the titles of the one that is printed, and rows that are among its rows.
    Shape,
}

impl Figure {
    /// The number of the table among those of its command, if it is one.
    pub(crate) fn table(&self) -> Option<usize> {
        let number = self.place.strip_prefix("table")?;
        match number.trim() {
            "" => Some(1),
            number => number.parse().ok(),
        }
    }
}

/// All figures of a document.
pub(crate) fn figures(text: &str) -> Vec<Figure> {
    let mut all = Vec::new();
    for (to, _) in text.match_indices(BEGIN) {
        let rest = &text[to + BEGIN.len()..];
        let inside = &rest[..rest.find(END).unwrap()];
        // Two dashes would end the comment for some readers of Markdown, who would show the rest.
        assert!(!inside.contains("--"), "write -\\- for -- in `{inside}`");
        let [command, place, limit] = inside.split(" ; ").collect::<Vec<_>>()[..] else {
            panic!("`{inside}` is not `command ; place ; factor`");
        };
        let (limit, is_long) = match limit.strip_suffix(", long") {
            Some(limit) => (limit, true),
            None => (limit, false),
        };
        let mut figure = Figure {
            from: 0,
            to,
            command: command.replace("-\\-", "--"),
            place: place.into(),
            limit: match limit {
                "shape" => Limit::Shape,
                factor => Limit::Factor(factor.parse().unwrap()),
            },
            is_long,
        };
        figure.from = if figure.table().is_some() {
            let lines = text[..to].split_inclusive('\n').rev();
            let rows = lines.skip_while(|line| line.trim().is_empty());
            let rows = rows.take_while(|line| line.starts_with('|'));
            let length: usize = rows.map(str::len).sum();
            assert!(length > 0, "no table before `{inside}`");
            text[..to].trim_end().len() + 1 - length
        } else {
            let number = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
            let from = text[..to].trim_end_matches(number).len();
            let claimed = text[from..to].parse::<f64>();
            assert!(claimed.is_ok(), "no number before `{inside}`");
            from
        };
        all.push(figure);
    }
    all
}

/// A cell with more letters is a sentence: its numbers are not measured.
const MOST_LETTERS: usize = 6;

/// Figures that are not marked: tables with four decimals or more, by their titles, and numbers such as
/// 4.1e-9.
/// What stands in code is none.
pub(crate) fn without_source(text: &str) -> Vec<String> {
    let mut all = Vec::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        if line.starts_with("```") {
            lines.by_ref().find(|line| line.starts_with("```"));
        } else if line.starts_with('|') {
            let mut table = vec![line];
            while let Some(row) = lines.next_if(|line| line.starts_with('|')) {
                table.push(row);
            }
            let is_marked = lines.peek().is_some_and(|line| line.starts_with(BEGIN));
            let cells = table.iter().flat_map(|row| row.split('|'));
            let of_figures = cells.filter(|cell| {
                let letters = cell.chars().filter(|c| c.is_alphabetic());
                cell.contains(BEGIN) || letters.count() <= MOST_LETTERS
            });
            let decimals = of_figures.flat_map(decimals).count();
            if !is_marked && decimals >= 4 {
                all.push(line.to_owned());
            }
        } else {
            all.extend(decimals(line).into_iter().filter(|x| x.contains('e')));
        }
    }
    all
}

/// Numbers with decimals in a line, but those in code and those with a mark behind them.
fn decimals(line: &str) -> Vec<String> {
    let mut all = Vec::new();
    for (number, part) in line.split('`').enumerate() {
        if number % 2 == 1 {
            continue;
        }
        let mut rest = part;
        while let Some(begin) = rest.find(|c: char| c.is_ascii_digit()) {
            let in_number = |c: char| c.is_ascii_digit() || ".e-".contains(c);
            let length = rest[begin..]
                .find(|c| !in_number(c))
                .unwrap_or(rest.len() - begin);
            let (found, behind) = rest[begin..].split_at(length);
            rest = behind.strip_prefix(BEGIN).map_or(behind, |mark| {
                mark.find(END).map_or("", |end| &mark[end + END.len()..])
            });
            let has_mark = behind.starts_with(BEGIN);
            let mut digits = found.split('.').skip(1);
            if !has_mark && digits.any(|part| part.starts_with(|c: char| c.is_ascii_digit())) {
                all.push(found.trim_end_matches('.').to_owned());
            }
        }
    }
    all
}

/// All documents that claim figures.
pub(crate) fn documents() -> Vec<PathBuf> {
    let root = root();
    let mut all = vec![root.join("README.md"), root.join("python/README.md")];
    for entry in std::fs::read_dir(root.join("docs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "md") {
            all.push(path);
        }
    }
    all
}

pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
