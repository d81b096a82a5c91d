//! The figures of the documents, measured again.
//!
//! A figure is followed by a comment that says where it comes from,
//! `4.1e-9<!--= run kepler -\-method gauss ; energy/max ; 2 -->`: the command, as a shell takes it, the place
//! in what it prints, and the factor by which it may differ. Commands are those of the program, whose JSON is
//! read, or those of a shell at the root, which print tables. Places in JSON are names, lists are entered by
//! `name`, by number or by `key=value, key=value`; in tables they are `ROW/COLUMN`. Behind a whole table
//! stands `<!--= growth ; table ; 3 -->`: it is the one that the command prints, cell by cell; `table 2` is
//! the second of several. In place of a factor `shape` compares no times: titles are those that the command
//! prints, and rows are among its rows. With `, long` behind the factor it is measured only when asked for.
//!
//! `.ci/figures` runs this. `EQUIP_FIGURES` in the environment may have `write`, which puts figures right,
//! and `long`; other words pick the commands that contain one of them.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

mod compare;
mod marks;
mod measure;

use compare::{differences, is_within, like, numbers};
use marks::{Figure, Limit, documents, figures, without_source};
use measure::{Measured, measure, tables};
use std::collections::{BTreeSet, HashMap};
use std::time::Instant;

/// What stands there, and if that is not what is measured: both in words, and what is to stand there.
fn compared(claimed: &str, figure: &Figure, measured: &Measured) -> Result<(), (String, String)> {
    let nothing = || Err(("nothing measured".to_owned(), claimed.to_owned()));
    if let Some(number) = figure.table() {
        let Some(now) = measured.table(number) else {
            return nothing();
        };
        let all = differences(claimed, now, figure.limit);
        return match all.is_empty() {
            true => Ok(()),
            false => Err((all.join("; "), now.to_owned())),
        };
    }
    let Some(now) = measured.at(&figure.place) else {
        return nothing();
    };
    let is_alike = match figure.limit {
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
    for path in documents() {
        let mut text = std::fs::read_to_string(&path).unwrap();
        // From the end, so that what is put right moves no other.
        for figure in figures(&text).into_iter().rev() {
            let command = &figure.command;
            if !picked.is_empty() && !picked.iter().any(|word| command.contains(word)) {
                continue;
            }
            if figure.is_long && !has("long") {
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
            let claimed = &text[figure.from..figure.to];
            if let Err((what, now)) = compared(claimed, &figure, measured) {
                let name = path.file_name().unwrap().display();
                wrong.push(format!("{name}: {what}: {command} ({})", figure.place));
                if has("write") {
                    text.replace_range(figure.from..figure.to, &now);
                }
            }
        }
        if has("write") {
            std::fs::write(&path, text).unwrap();
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

#[test]
fn figures_are_found_where_they_stand() {
    let text = "| 4.1e-9<!--= run kepler ; energy/max ; 2 --> | 12<!--= run fpu -\\-quiet ; steps ; 1, long --> |";
    let found = figures(text);
    assert_eq!(found.len(), 2);
    assert_eq!(&text[found[0].from..found[0].to], "4.1e-9");
    assert_eq!(
        (found[0].limit, found[0].is_long),
        (Limit::Factor(2.0), false)
    );
    assert_eq!(
        (found[1].command.as_str(), found[1].place.as_str()),
        ("run fpu --quiet", "steps")
    );
    assert!(found[1].is_long);
    let table = "text\n\n| a | b |\n|---|---|\n| 1e-3 | 2 |\n<!--= growth ; table 2 ; shape -->";
    let found = figures(table);
    assert_eq!(
        &table[found[0].from..found[0].to],
        "| a | b |\n|---|---|\n| 1e-3 | 2 |\n"
    );
    assert_eq!((found[0].table(), found[0].limit), (Some(2), Limit::Shape));
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

/// A figure whose source cannot be read would never be measured, and one without a source is not either:
/// tables of figures have a mark behind or within them, and numbers like 4.1e-9 one behind them.
#[test]
fn every_figure_has_a_source() {
    let mut wrong = Vec::new();
    for path in documents() {
        let text = std::fs::read_to_string(&path).unwrap();
        figures(&text);
        let name = path.file_name().unwrap().display();
        wrong.extend(
            without_source(&text)
                .iter()
                .map(|figure| format!("{name}: {figure}")),
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The same figure of two places has the same digits in both.
#[test]
fn no_figure_contradicts_another() {
    let mut first: HashMap<(String, String), String> = HashMap::new();
    let mut wrong = Vec::new();
    for path in documents() {
        let text = std::fs::read_to_string(&path).unwrap();
        for figure in figures(&text) {
            let claimed = text[figure.from..figure.to].trim().to_owned();
            let source = (figure.command, figure.place);
            let other = first.entry(source.clone()).or_insert(claimed.clone());
            if *other != claimed {
                wrong.push(format!("{source:?}: {other} and {claimed}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn figures_without_a_source_are_found() {
    let all = without_source(
        "About 1.5e-3 of `2.5e-3`, 3.5e-3<!--= run fpu ; steps ; 1 -->.\n```\n4.5e-3\n```\n\
         | a |\n|---|\n| 5.5e-3 |\n<!--= growth ; table ; 3 -->\n\
         | b |\n|---|\n| 1.5, 2.5 |\n| 3.5; 4.5 |\n\n",
    );
    assert_eq!(all, ["1.5e-3", "| b |"]);
}
