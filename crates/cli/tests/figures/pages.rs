//! Figures in the text of a page: those that have a source, and those that have none.

use crate::sources::{Anchor, Source, sources};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A figure, or a table, with where it stands in the text.
#[derive(Debug)]
pub(crate) struct Figure<'a> {
    pub(crate) place: Range<usize>,
    pub(crate) source: &'a Source,
}

/// All figures of a page that have a source, in their order; each must be there once.
pub(crate) fn figures<'a>(page: &str, text: &str, sources: &'a [Source]) -> Vec<Figure<'a>> {
    let mine = sources.iter().filter(|source| source.page == page);
    let mut all: Vec<Figure> = mine
        .map(|source| {
            let found = places(text, &source.anchor);
            let count = found.len();
            let [place] = <[_; 1]>::try_from(found)
                .unwrap_or_else(|_| panic!("{page}: {count} times in the page: {source:?}"));
            Figure { place, source }
        })
        .collect();
    all.sort_by_key(|figure| figure.place.start);
    for pair in all.windows(2) {
        let is_apart = pair[0].place.end <= pair[1].place.start;
        assert!(is_apart, "{page}: two sources of one figure: {pair:?}");
    }
    all
}

/// All places in a text that an anchor describes.
fn places(text: &str, anchor: &Anchor) -> Vec<Range<usize>> {
    match anchor {
        Anchor::Between { before, after } => {
            let (squeezed, origins) = squeeze(text);
            let mut found = numbers(&squeezed);
            found.retain(|number| {
                squeezed[..number.start].ends_with(before.as_str())
                    && squeezed[number.end..].starts_with(after.as_str())
            });
            let of_text = |number: Range<usize>| origins[number.start]..origins[number.end - 1] + 1;
            found.into_iter().map(of_text).collect()
        }
        Anchor::Table { section, number } => {
            let found = tables(text, section);
            found.into_iter().skip(number - 1).take(1).collect()
        }
        Anchor::Cell {
            section,
            row,
            column,
        } => {
            let mut all = Vec::new();
            for table in tables(text, section) {
                all.extend(cells_in(text, table, row, column));
            }
            all
        }
    }
}

/// The cells of a table in rows and columns of these names; each must be a number.
fn cells_in(text: &str, table: Range<usize>, row: &str, column: &str) -> Vec<Range<usize>> {
    let mut begin = table.start;
    let lines = text[table].split_inclusive('\n').map(|line| {
        let cells = cells(line, begin);
        begin += line.len();
        cells
    });
    let lines: Vec<Vec<Range<usize>>> = lines.collect();
    let is_column = |&column_number: &usize| &text[lines[0][column_number].clone()] == column;
    let columns: Vec<usize> = (1..lines[0].len()).filter(is_column).collect();
    let mut all = Vec::new();
    for line in &lines[1..] {
        if line.get(1).is_some_and(|cell| &text[cell.clone()] == row) {
            all.extend(columns.iter().filter_map(|&column| line.get(column)));
        }
    }
    for &cell in &all {
        let cell = &text[cell.clone()];
        assert!(cell.parse::<f64>().is_ok(), "not a number: `{cell}`");
    }
    all.into_iter().cloned().collect()
}

/// The cells of a line that begins at a place, without the blanks around them.
fn cells(line: &str, begin: usize) -> Vec<Range<usize>> {
    let mut from = begin;
    let cells = line.split('|').map(|cell| {
        let start = from + cell.len() - cell.trim_start().len();
        from += cell.len() + 1;
        start..start + cell.trim().len()
    });
    cells.collect()
}

/// The tables of a section, which begins with its title and ends with the next one.
fn tables(text: &str, section: &str) -> Vec<Range<usize>> {
    let (mut all, mut begin) = (Vec::<Range<usize>>::new(), 0);
    let (mut is_code, mut is_inside, mut is_table, mut sections) = (false, false, false, 0);
    for line in text.split_inclusive('\n') {
        let end = begin + line.len();
        if line.starts_with("```") {
            is_code = !is_code;
        } else if line.starts_with('#') && !is_code {
            is_inside = line.trim_start_matches('#').trim() == section;
            sections += usize::from(is_inside);
        }
        let is_row = is_inside && !is_code && line.starts_with('|');
        match all.last_mut() {
            Some(table) if is_row && is_table => table.end = end,
            _ if is_row => all.push(begin..end),
            _ => {}
        }
        (is_table, begin) = (is_row, end);
    }
    assert_eq!(sections, 1, "sections named `{section}`");
    all
}

/// A text with a blank in place of each run of white space, and the place of each of its bytes in the other.
fn squeeze(text: &str) -> (String, Vec<usize>) {
    let (mut squeezed, mut origins) = (String::new(), Vec::new());
    for (place, next) in text.char_indices() {
        let next = if next.is_whitespace() { ' ' } else { next };
        if next != ' ' || !squeezed.ends_with(' ') {
            squeezed.push(next);
            origins.extend(place..place + next.len_utf8());
        }
    }
    (squeezed, origins)
}

/// All numbers of a text, without the full stop behind them.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let (mut all, mut from) = (Vec::new(), 0);
    while let Some(skip) = text[from..].find(|c: char| c.is_ascii_digit()) {
        let mut start = from + skip;
        let length = text[start..].find(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c)));
        let mut end = length.map_or(text.len(), |length| start + length);
        while text[start..end].ends_with('.') || text[start..end].parse::<f64>().is_err() {
            end -= 1;
        }
        start -= usize::from(text[..start].ends_with('-'));
        if !text[..start].ends_with(|c: char| c.is_alphanumeric() || c == '.') {
            all.push(start..end);
        }
        from = end;
    }
    all
}

/// Stands in place of a number that has a source.
const HIDDEN: char = '\0';

/// A cell with more letters is a sentence: its numbers are not measured.
const MOST_LETTERS: usize = 6;

/// Figures that have no source: tables with four decimals or more, by their titles, and numbers such as
/// 4.1e-9.
/// What stands in code is none.
pub(crate) fn without_source(text: &str, figures: &[Figure]) -> Vec<String> {
    let mut text = text.to_owned();
    for figure in figures.iter().rev() {
        let instead = match figure.source.table() {
            Some(_) => String::new(),
            None => HIDDEN.to_string(),
        };
        text.replace_range(figure.place.clone(), &instead);
    }
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
            let cells = table.iter().flat_map(|row| row.split('|'));
            let of_figures = cells.filter(|cell| {
                let letters = cell.chars().filter(|c| c.is_alphabetic());
                cell.contains(HIDDEN) || letters.count() <= MOST_LETTERS
            });
            if of_figures.flat_map(decimals).count() >= 4 {
                all.push(line.to_owned());
            }
        } else {
            all.extend(decimals(line).into_iter().filter(|x| x.contains('e')));
        }
    }
    all
}

/// Numbers with decimals in a line, except those in code.
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
            rest = behind;
            let mut digits = found.split('.').skip(1);
            if digits.any(|part| part.starts_with(|c: char| c.is_ascii_digit())) {
                all.push(found.trim_end_matches('.').to_owned());
            }
        }
    }
    all
}

/// All documents that claim figures, by their paths from the root.
pub(crate) fn documents() -> Vec<String> {
    let mut all = vec!["README.md".to_owned(), "python/README.md".to_owned()];
    for entry in std::fs::read_dir(root().join("docs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "md") {
            let name = path.file_name().unwrap().display();
            all.push(format!("docs/{name}"));
        }
    }
    all
}

pub(crate) fn read(page: &str) -> String {
    std::fs::read_to_string(root().join(page)).unwrap()
}

/// The sources of all figures, each of a document.
pub(crate) fn all_sources() -> Vec<Source> {
    let all = sources(&read("docs/figures.toml"));
    let pages = documents();
    for source in &all {
        assert!(pages.contains(&source.page), "no page: {source:?}");
    }
    all
}

pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}
