//! The figures of the documents, measured again.
//!
//! A figure is followed by a comment that says where it comes from,
//! `4.1e-9<!--= run kepler --method gauss ; energy/max ; 2 -->`: the command, the place in its JSON, and the
//! factor by which it may differ. `.ci/figures` runs this; with `EQUIP_FIGURES=write` in the environment the
//! figures are put right instead.
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

/// All figures of a document.
fn figures(text: &str) -> Vec<Figure> {
    let mut all = Vec::new();
    for (to, _) in text.match_indices(BEGIN) {
        let rest = &text[to + BEGIN.len()..];
        let inside = &rest[..rest.find(END).unwrap()];
        let [command, place, factor] = inside.split(" ; ").collect::<Vec<_>>()[..] else {
            panic!("`{inside}` is not `command ; place ; factor`");
        };
        let number = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
        let from = text[..to].trim_end_matches(number).len();
        all.push(Figure {
            from,
            to,
            claimed: text[from..to].parse().unwrap(),
            command: command.into(),
            place: place.into(),
            factor: factor.parse().unwrap(),
        });
    }
    all
}

/// The number at a place like `energy/max` or `invariants/angular momentum/max`.
fn at(document: &Value, place: &str) -> f64 {
    let mut value = document;
    for name in place.split('/') {
        value = match value {
            Value::Array(list) => list.iter().find(|x| x["name"] == name).unwrap(),
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
            let document = measured.entry(figure.command.clone()).or_insert_with(|| {
                let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
                let output = program
                    .args(figure.command.split(' '))
                    .arg("--json")
                    .output();
                serde_json::from_slice(&output.unwrap().stdout).unwrap()
            });
            let now = at(document, &figure.place);
            count += 1;
            let ratio = now / figure.claimed;
            if !(ratio <= figure.factor && ratio >= 1.0 / figure.factor) {
                wrong.push(format!(
                    "{}: {:e} claimed, {now:.1e} measured: equip {} ({})",
                    path.file_name().unwrap().display(),
                    figure.claimed,
                    figure.command,
                    figure.place
                ));
                if writes {
                    text.replace_range(figure.from..figure.to, &format!("{now:.1e}"));
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
    let document = serde_json::json!({"invariants": [{"name": "momentum", "max": 3.0}]});
    assert_eq!(at(&document, "invariants/momentum/max"), 3.0);
}

/// A figure whose source cannot be read would never be measured.
#[test]
fn every_figure_can_be_read() {
    for path in documents() {
        figures(&std::fs::read_to_string(&path).unwrap());
    }
}
