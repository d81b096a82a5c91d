//! The figures of the documents, measured again.
//!
//! A figure is followed by a comment that says where it comes from,
//! `4.1e-9<!--= run kepler --method gauss ; energy/max ; 2 -->`: the command, the place in its JSON, and the
//! factor by which it may differ. Lists are entered by `name` or by number. Behind a whole table stands
//! `<!--= growth ; table ; 3 -->`: it is the one that the command prints, cell by cell. `.ci/figures` runs
//! this; with `EQUIP_FIGURES=write` in the environment the figures are put right instead.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

use serde_json::Value;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::Command;

const BEGIN: &str = "<!--= ";
const END: &str = " -->";

/// A figure with where it stands in the text.
#[derive(Debug, PartialEq)]
struct Figure {
    from: usize,
    to: usize,
    claimed: f64,
    command: String,
    place: String,
    factor: f64,
}

impl Figure {
    fn is_table(&self) -> bool {
        self.place == "table"
    }
}

/// All figures of a document.
fn figures(text: &str) -> Vec<Figure> {
    let mut all = Vec::new();
    for (to, _) in text.match_indices(BEGIN) {
        let rest = &text[to + BEGIN.len()..];
        let inside = &rest[..rest.find(END).unwrap()];
        let [command, place, factor] = inside.split(" ; ").collect::<Vec<_>>()[..] else {
            panic!("`{inside}` is not `command ; place ; factor`");
        };
        let (from, claimed) = if place == "table" {
            let lines = text[..to].split_inclusive('\n').rev();
            let rows = lines.skip_while(|line| line.trim().is_empty());
            let rows = rows.take_while(|line| line.starts_with('|'));
            let length: usize = rows.map(str::len).sum();
            let end = text[..to].trim_end().len() + 1;
            (end - length, f64::NAN)
        } else {
            let number = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
            let from = text[..to].trim_end_matches(number).len();
            (from, text[from..to].parse().unwrap())
        };
        all.push(Figure {
            from,
            to,
            claimed,
            command: command.into(),
            place: place.into(),
            factor: factor.parse().unwrap(),
        });
    }
    all
}

/// What a command measures: its JSON, or the table that it prints.
fn measure(command: &str) -> Value {
    let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("figures");
    std::fs::create_dir_all(&home).unwrap();
    let run = |more: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
        let program = program
            .current_dir(&home)
            .args(command.split(' ').chain(more.iter().copied()));
        String::from_utf8(program.output().unwrap().stdout).unwrap()
    };
    match command.split(' ').next() {
        Some("run") => serde_json::from_str(&run(&["--json"])).unwrap(),
        Some("check") => {
            run(&["--json", "check.json"]);
            serde_json::from_slice(&std::fs::read(home.join("check.json")).unwrap()).unwrap()
        }
        _ => {
            let text = run(&[]);
            let rows = text
                .split_inclusive('\n')
                .filter(|line| line.starts_with('|'));
            Value::String(rows.collect())
        }
    }
}

/// The cells of two tables that differ by more than `factor`, or, where they are rounded to 0.01 or to
/// whole numbers, by more than three of these.
fn differences(claimed: &str, measured: &str, factor: f64) -> Vec<String> {
    let cells = |table: &str| -> Vec<Vec<String>> {
        let cells = |row: &str| {
            row.split('|')
                .map(|cell| cell.trim().replace("**", ""))
                .collect()
        };
        table.lines().map(cells).collect()
    };
    let (old, new) = (cells(claimed), cells(measured));
    let mut all = Vec::new();
    if old.iter().map(Vec::len).ne(new.iter().map(Vec::len)) {
        all.push(format!(
            "{} rows claimed, {} measured",
            old.len(),
            new.len()
        ));
    }
    for (old, new) in old.iter().flatten().zip(new.iter().flatten()) {
        let is_alike = match (old.parse::<f64>(), new.parse::<f64>()) {
            (Ok(x), Ok(y)) => {
                let unit = if old.contains('e') {
                    0.0
                } else if old.contains('.') {
                    0.01
                } else {
                    1.0
                };
                let ratio = y / x;
                (x - y).abs() <= 3.01 * unit || (ratio <= factor && ratio >= 1.0 / factor)
            }
            _ => old == new || old.starts_with("---"),
        };
        if !is_alike {
            all.push(format!("{old} claimed, {new} measured"));
        }
    }
    all
}

/// The number at a place like `energy/max` or `invariants/angular momentum/max`.
fn at(document: &Value, place: &str) -> f64 {
    let mut value = document;
    for name in place.split('/') {
        value = match value {
            Value::Array(list) => match name.parse::<usize>() {
                Ok(number) => &list[number],
                Err(_) => list.iter().find(|x| x["name"] == name).unwrap(),
            },
            other => &other[name],
        };
    }
    value
        .as_f64()
        .unwrap_or_else(|| panic!("no number at {place}"))
}

fn documents() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut all = vec![root.join("README.md")];
    for entry in std::fs::read_dir(root.join("docs")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "md") {
            all.push(path);
        }
    }
    all
}

#[test]
#[ignore = "measures for a minute: run with .ci/figures"]
fn the_figures_of_the_documents_are_those_measured() {
    let writes = std::env::var("EQUIP_FIGURES").is_ok_and(|mode| mode == "write");
    let mut measured: HashMap<String, Value> = HashMap::new();
    let (mut wrong, mut count) = (Vec::new(), 0);
    for path in documents() {
        let mut text = std::fs::read_to_string(&path).unwrap();
        // From the end, so that what is put right moves no other.
        for figure in figures(&text).into_iter().rev() {
            let command = &figure.command;
            let document = (measured.entry(command.clone())).or_insert_with(|| measure(command));
            let claimed = &text[figure.from..figure.to];
            let (is_alike, what, now) = if figure.is_table() {
                let now = document.as_str().unwrap();
                let all = differences(claimed.trim_end(), now.trim_end(), figure.factor);
                (all.is_empty(), all.join("; "), now.to_owned())
            } else {
                let now = at(document, &figure.place);
                let ratio = now / figure.claimed;
                let is_alike = now == figure.claimed
                    || (ratio <= figure.factor && ratio >= 1.0 / figure.factor);
                let is_count = !claimed.contains(['.', 'e']);
                let now = if is_count {
                    format!("{now}")
                } else {
                    format!("{now:.1e}")
                };
                (is_alike, format!("{claimed} claimed, {now} measured"), now)
            };
            count += 1;
            if !is_alike {
                wrong.push(format!(
                    "{}: {what}: equip {command} ({})",
                    path.file_name().unwrap().display(),
                    figure.place
                ));
                if writes {
                    text.replace_range(figure.from..figure.to, &now);
                }
            }
        }
        if writes {
            std::fs::write(&path, text).unwrap();
        }
    }
    assert!(count > 20, "{count} figures");
    println!(
        "{count} figures, {} of them differ\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(writes || wrong.is_empty());
}

#[test]
fn figures_are_found_where_they_stand() {
    let text = "| 4.1e-9<!--= run kepler ; energy/max ; 2 --> | 12<!--= run fpu ; steps ; 1 --> |";
    let found = figures(text);
    assert_eq!(found.len(), 2);
    assert_eq!(&text[found[0].from..found[0].to], "4.1e-9");
    assert_eq!((found[0].claimed, found[0].factor), (4.1e-9, 2.0));
    assert_eq!(
        (found[1].command.as_str(), found[1].place.as_str()),
        ("run fpu", "steps")
    );
    let table = "text\n\n| a | b |\n|---|---|\n| 1e-3 | 2 |\n<!--= growth ; table ; 3 -->";
    let found = figures(table);
    assert_eq!(
        &table[found[0].from..found[0].to],
        "| a | b |\n|---|---|\n| 1e-3 | 2 |\n"
    );
    let document = serde_json::json!({"invariants": [{"name": "momentum", "max": 3.0}]});
    assert_eq!(at(&document, "invariants/momentum/max"), 3.0);
}

#[test]
fn tables_are_compared_by_cells() {
    let table = "| a | 1e-3 | **2.0e-4** | 0.04 |\n";
    assert!(differences(table, "| a | 1.9e-3 | 1.1e-4 | 0.05 |\n", 2.0).is_empty());
    for other in [
        "| b | 1e-3 | 2e-4 | 0.04 |",
        "| a | 4e-3 | 2e-4 | 0.04 |",
        "| a | 1e-3 | 2e-4 | 0.4 |",
        "| a | 1e-3 | 2e-4 |",
        "",
    ] {
        assert!(!differences(table, other, 2.0).is_empty(), "{other}");
    }
}

/// A figure whose source cannot be read would never be measured.
#[test]
fn every_figure_can_be_read() {
    for path in documents() {
        figures(&std::fs::read_to_string(&path).unwrap());
    }
}
