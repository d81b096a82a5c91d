//! The figures of the documents, measured again.
//!
//! `docs/figures.toml` says where each figure comes from: its page, an anchor that is there once (text
//! around the number, `{}`; a cell by section, row and column; or a table of a section), the command, as a
//! shell takes it, the place in what it prints (`path`), and the factor by which it may differ. Commands are
//! those of the program, whose JSON is read, or those of a shell at the root, which print tables. Paths in
//! JSON are names, lists are entered by `name`, by number or by `key=value, key=value`; in tables they are
//! `ROW/COLUMN`. A whole table has the path `table`: it is the one that the command prints, cell by cell;
//! `table 2` is the second of several. In place of a factor `shape` compares no times: titles are those that
//! the command prints, and rows are among its rows. With `long = true` it is measured only when requested.
//!
//! `.ci/figures` runs this. `EQUIP_FIGURES` in the environment may have `write`, which puts figures right,
//! and `long`; other words pick the commands that contain one of them.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

mod compare;
mod measure;
mod pages;
mod sources;

use compare::{differences, is_within, like, numbers};
use measure::{Measured, measure, tables};
use pages::{Figure, all_sources, documents, figures, read, root, without_source};
use sources::{Anchor, Limit, Source, sources};
use std::collections::{BTreeSet, HashMap};
use std::time::Instant;

/// What stands there, and if that is not what is measured: both in words, and what is to stand there.
fn compared(claimed: &str, source: &Source, measured: &Measured) -> Result<(), (String, String)> {
    let nothing = || Err(("nothing measured".to_owned(), claimed.to_owned()));
    if let Some(number) = source.table() {
        let Some(now) = measured.table(number) else {
            return nothing();
        };
        let all = differences(claimed, now, source.limit);
        return match all.is_empty() {
            true => Ok(()),
            false => Err((all.join("; "), now.to_owned())),
        };
    }
    let Some(now) = measured.at(&source.path) else {
        return nothing();
    };
    let is_alike = match source.limit {
        Limit::Factor(factor) => is_within(claimed.parse().unwrap(), now, factor),
        Limit::Shape => true,
    };
    let now = like(claimed, now);
    match is_alike {
        true => Ok(()),
        false => Err((format!("{claimed} claimed, {now} measured"), now)),
    }
}

#[test]
#[ignore = "measures for minutes: run with .ci/figures"]
fn the_figures_of_the_documents_are_those_measured() {
    let modes = std::env::var("EQUIP_FIGURES").unwrap_or_default();
    let has = |mode| modes.split_whitespace().any(|word| word == mode);
    let words = modes.split_whitespace();
    let picked: Vec<&str> = words.filter(|&x| x != "write" && x != "long").collect();
    let mut results: HashMap<String, Measured> = HashMap::new();
    let (mut wrong, mut count, mut left) = (Vec::new(), 0, 0);
    let mut others = BTreeSet::new();
    let sources = all_sources();
    for page in documents() {
        let mut text = read(&page);
        // From the end, so that what is put right moves no other.
        for Figure { place, source } in figures(&page, &text.clone(), &sources).into_iter().rev() {
            let command = &source.command;
            if !picked.is_empty() && !picked.iter().any(|word| command.contains(word)) {
                continue;
            }
            if source.is_long && !has("long") {
                left += 1;
                others.insert(command.clone());
                continue;
            }
            let measured = results.entry(command.clone()).or_insert_with(|| {
                let begun = Instant::now();
                let measured = measure(command);
                println!("{:6.1} s  {command}", begun.elapsed().as_secs_f64());
                measured
            });
            count += 1;
            if let Err((what, now)) = compared(&text[place.clone()], source, measured) {
                wrong.push(format!("{page}: {what}: {command} ({})", source.path));
                if has("write") {
                    text.replace_range(place, &now);
                }
            }
        }
        if has("write") {
            std::fs::write(root().join(&page), text).unwrap();
        }
    }
    assert!(count > 100 || !picked.is_empty(), "{count} figures");
    println!(
        "{count} figures, {} of them differ\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    for command in others {
        println!("not measured: {command}");
    }
    if left > 0 {
        println!("{left} more figures and tables: .ci/figures long");
    }
    assert!(has("write") || wrong.is_empty());
}

const SOURCES: &str = r#"
# Of two pages.
[[figure]]
page = "a.md"
at = "about {}. Of"
command = "run kepler"
path = "energy/max"
factor = 2

[[figure]]
page = "a.md"
section = "Steps"
row = "`fpu`"
column = "steps"
command = "run fpu --quiet"
path = "steps"
factor = 1
long = true

[[figure]]
page = "a.md"
section = "Growth"
table = 2
command = "growth"
path = "table 2"
factor = "shape"

[[figure]]
page = "b.md"
at = "\"{}\""
command = "growth"
path = "x/y"
factor = 1.5
"#;

const PAGE: &str = "An error of\nabout 4.1e-9. Of 5.1e-9 nothing.\n\n## Steps\n\n\
    | | energy | steps |\n|---|---|---|\n| `kepler` | 1 | 2 |\n| `fpu` | 3 | -12 |\n\n\
    ```sh\n# Growth\n```\n\n### Growth\n\n| a |\n|---|\n\n| a | b |\n|---|---|\n| 1e-3 | 2 |\n";

#[test]
fn figures_are_found_where_they_stand() {
    let sources = sources(SOURCES);
    let found = figures("a.md", PAGE, &sources);
    let texts: Vec<&str> = found.iter().map(|x| &PAGE[x.place.clone()]).collect();
    let table = "| a | b |\n|---|---|\n| 1e-3 | 2 |\n";
    assert_eq!(texts, ["4.1e-9", "-12", table]);
    let of_fpu = found[1].source;
    assert_eq!(
        (of_fpu.command.as_str(), of_fpu.path.as_str()),
        ("run fpu --quiet", "steps")
    );
    assert!(of_fpu.is_long && !found[0].source.is_long);
    assert_eq!(found[0].source.limit, Limit::Factor(2.0));
    assert_eq!(
        (found[2].source.table(), found[2].source.limit),
        (Some(2), Limit::Shape)
    );
    let quoted = Anchor::Between {
        before: "\"".into(),
        after: "\"".into(),
    };
    assert_eq!(sources[3].anchor, quoted);
}

/// An anchor that is not there, or there twice, and two sources of one figure would measure something else.
#[test]
fn an_anchor_is_there_once() {
    let source = |at: &str| SOURCES.replace("about {}. Of", at);
    let found = |text: &str| figures("a.md", PAGE, &sources(text)).len();
    assert_eq!(found(&source("of about {}.")), 3);
    for at in ["about {} of", "{}e-9", " {}. of", "{}", "| `fpu` | 3 | {}"] {
        let text = source(at);
        assert!(std::panic::catch_unwind(|| found(&text)).is_err(), "{at}");
    }
    for (old, new) in [
        ("`fpu`", "fpu"),
        ("Growth", "Grown"),
        ("table = 2", "table = 3"),
        ("factor = 2", "factor = 2\nfactors = 2"),
        ("long = true", "long = yes"),
    ] {
        let text = SOURCES.replace(old, new);
        assert!(std::panic::catch_unwind(|| found(&text)).is_err(), "{new}");
    }
}

#[test]
fn places_are_found() {
    let document = serde_json::json!({"invariants": [{"name": "momentum", "max": 3.0}]});
    let document = Measured::Json(document);
    assert_eq!(document.at("invariants/momentum/max"), Some(3.0));
    assert_eq!(document.at("invariants/name=momentum/max"), Some(3.0));
    assert_eq!(document.at("invariants/name=momentum, max=4/max"), None);
    assert_eq!(document.at("invariants/energy/max"), None);
    let text = "running\n| | a | b |\n|---|---|---|\n| x/y | 1 | **2.5** of 3 |\nok\n| c |\n";
    let printed = Measured::Tables(tables(text));
    assert_eq!(printed.at("x/y/b"), Some(2.5));
    assert_eq!(printed.at("x/y/c"), None);
    assert_eq!(printed.table(2), Some("| c |\n"));
    assert_eq!(printed.table(3), None);
}

#[test]
fn numbers_are_read_and_written() {
    let (text, found) = numbers("q2 is −1.5e-3, **12** of 0.25 %");
    assert_eq!(text, "q2 is #, # of # %");
    let values: Vec<f64> = found.iter().map(|number| number.value).collect();
    assert_eq!(values, [-1.5e-3, 12.0, 0.25]);
    let units: Vec<f64> = found.iter().map(|number| number.unit).collect();
    assert!(units[0] == 0.0 && units[1] == 1.0 && (units[2] - 0.01).abs() < 1e-9);
    assert_eq!(like("4.1e-9", 2.34e-8), "2.3e-8");
    assert_eq!(
        (like("12", 57.4), like("0.06", 0.125)),
        ("57".into(), "0.12".into())
    );
}

#[test]
fn tables_are_compared_by_cells() {
    let factor = Limit::Factor(2.0);
    let table = "| s |\n| a | 1e-3 | **2.0e-4**, 0.04 |\n";
    let alike = "| s |\n| a | 1.9e-3 | 1.1e-4, 0.06 |\n";
    assert!(differences(table, alike, factor).is_empty());
    for other in [
        "| s |\n| b | 1e-3 | 2e-4, 0.04 |",
        "| s |\n| a | 4e-3 | 2e-4, 0.04 |",
        "| s |\n| a | 1e-3 | 2e-4, 0.4 |",
        "| s |\n| a | 1e-3 | 2e-4; 0.04 |",
        "| s |\n| a | 1e-3 |",
        "| t |\n| a | 1e-3 | 2e-4, 0.04 |",
        "",
    ] {
        assert!(!differences(table, other, factor).is_empty(), "{other}");
    }
    let table = "| s | t |\n|---|---|\n| a | 1 ms |\n";
    let printed = "| s | t |\n|---|---|\n| b | 7 ms |\n| a | – |\n";
    assert!(differences(table, printed, Limit::Shape).is_empty());
    assert_eq!(differences(printed, table, Limit::Shape).len(), 1);
    assert!(!differences(table, &printed.replace('t', "r"), Limit::Shape).is_empty());
}

/// A figure whose source cannot be found would never be measured, and one without a source is not either:
/// tables of figures, and numbers like 4.1e-9, are in `docs/figures.toml`.
#[test]
fn every_figure_has_a_source() {
    let sources = all_sources();
    let mut wrong = Vec::new();
    for page in documents() {
        let text = read(&page);
        let all = figures(&page, &text, &sources);
        let without = without_source(&text, &all);
        wrong.extend(without.iter().map(|figure| format!("{page}: {figure}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The same figure of two places has the same digits in both.
#[test]
fn no_figure_contradicts_another() {
    let sources = all_sources();
    let mut first: HashMap<(&str, &str), String> = HashMap::new();
    let mut wrong = Vec::new();
    for page in documents() {
        let text = read(&page);
        for Figure { place, source } in figures(&page, &text, &sources) {
            let claimed = text[place].trim().to_owned();
            let source = (source.command.as_str(), source.path.as_str());
            let other = first.entry(source).or_insert(claimed.clone());
            if *other != claimed {
                wrong.push(format!("{source:?}: {other} and {claimed}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn figures_without_a_source_are_found() {
    let text = "About 1.5e-3 of `2.5e-3`, about 3.5e-3. Of\n```\n4.5e-3\n```\n\
         ## Growth\n| a |\n|---|\n| 5.5e-3 |\n\n| b |\n|---|\n| 1.5, 2.5 |\n| 3.5; 4.5 |\n\n";
    let mut all = sources(SOURCES);
    all.retain(|source| source.table().is_some() || source.path == "energy/max");
    let missing = |all: &[Source]| without_source(text, &figures("a.md", text, all));
    assert_eq!(missing(&all), ["1.5e-3"]);
    all.pop();
    assert_eq!(missing(&all), ["1.5e-3", "| b |"]);
    assert_eq!(missing(&[]), ["1.5e-3", "3.5e-3", "| b |"]);
}
