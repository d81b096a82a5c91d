//! `docs/figures.toml`: where each figure of the documents comes from.

/// Where a figure comes from, and where it stands.
#[derive(Debug, PartialEq)]
pub(crate) struct Source {
    /// The path of the document from the root.
    pub(crate) page: String,
    pub(crate) anchor: Anchor,
    pub(crate) command: String,
    /// The place in what the command prints.
    pub(crate) path: String,
    pub(crate) limit: Limit,
    /// Its command takes minutes or needs other programs, and runs only if `long` is requested.
    pub(crate) is_long: bool,
}

/// Where a figure stands in its page.
#[derive(Debug, PartialEq)]
pub(crate) enum Anchor {
    /// A number between two pieces of text.
    Between { before: String, after: String },
    /// The cell of a table of a section, by its first cell in the row and the title of its column.
    Cell {
        section: String,
        row: String,
        column: String,
    },
    /// A table of a section, from 1 on.
    Table { section: String, number: usize },
}

/// How near to the measured figure it must be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Limit {
    Factor(f64),
    /// A table of times: it has the titles of the one that is printed, and rows that are among its rows.
    Shape,
}

impl Source {
    /// The number of the table among those of its command, if it is one.
    pub(crate) fn table(&self) -> Option<usize> {
        let number = self.path.strip_prefix("table")?;
        match number.trim() {
            "" => Some(1),
            number => number.parse().ok(),
        }
    }
}

/// All sources of a text in TOML: tables `[[figure]]` of strings, numbers and `true`, one entry a line.
pub(crate) fn sources(text: &str) -> Vec<Source> {
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    let mut lines = lines.filter(|line| !line.starts_with('#')).peekable();
    let mut all = Vec::new();
    while let Some(line) = lines.next() {
        assert_eq!(line, "[[figure]]");
        let mut entries = Entries(Vec::new());
        while let Some(line) = lines.next_if(|line| *line != "[[figure]]") {
            entries.push(line);
        }
        all.push(source(entries));
    }
    all
}

fn source(mut entries: Entries) -> Source {
    let whole = format!("{:?}", entries.0);
    let mut must = |key| {
        let value = entries.take(key);
        value.unwrap_or_else(|| panic!("no `{key}` in {whole}"))
    };
    let (page, command) = (must("page"), must("command"));
    let (path, factor) = (must("path"), must("factor"));
    let anchor = match (entries.take("at"), entries.take("section")) {
        (Some(at), None) => {
            let (before, after) = at.split_once("{}").unwrap();
            assert!(!after.contains("{}"), "two figures in `{at}`");
            Anchor::Between {
                before: before.into(),
                after: after.into(),
            }
        }
        (None, Some(section)) => match (entries.take("row"), entries.take("column")) {
            (Some(row), Some(column)) => Anchor::Cell {
                section,
                row,
                column,
            },
            (None, None) => Anchor::Table {
                section,
                number: entries.take("table").map_or(1, |x| x.parse().unwrap()),
            },
            _ => panic!("`row` without `column`, or without `row`, in {whole}"),
        },
        _ => panic!("either `at` or `section` in {whole}"),
    };
    let source = Source {
        page,
        anchor,
        command,
        path,
        limit: match factor.as_str() {
            "shape" => Limit::Shape,
            factor => Limit::Factor(factor.parse().unwrap()),
        },
        is_long: entries.take("long").is_some(),
    };
    assert!(entries.0.is_empty(), "unknown: {:?}", entries.0);
    let is_table = matches!(source.anchor, Anchor::Table { .. });
    assert_eq!(is_table, source.table().is_some(), "in {whole}");
    source
}

/// Keys and values of one figure.
struct Entries(Vec<(String, String)>);

impl Entries {
    fn push(&mut self, line: &str) {
        let (key, value) = line.split_once(" = ").unwrap();
        let text = value.strip_prefix('"').and_then(|x| x.strip_suffix('"'));
        let is_plain = value == "true" || value.parse::<f64>().is_ok();
        assert!(
            text.is_some() || is_plain,
            "neither text nor number: {line}"
        );
        let value = text.unwrap_or(value).replace("\\\"", "\"");
        assert!(
            self.0.iter().all(|(other, _)| other != key),
            "twice: {line}"
        );
        assert!(!value.contains('\\'), "an escape that is not read: {line}");
        self.0.push((key.into(), value));
    }

    fn take(&mut self, key: &str) -> Option<String> {
        let place = self.0.iter().position(|(other, _)| other == key)?;
        Some(self.0.remove(place).1)
    }
}
