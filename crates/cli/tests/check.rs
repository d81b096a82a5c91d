//! `equip check` on rows that take a moment.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

use serde_json::Value;
use std::path::PathBuf;
use std::process::{Command, Output};

fn check(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_equip"))
        .arg("check")
        .args(arguments)
        .output()
        .unwrap()
}

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

#[test]
fn rows_at_rest_pass_and_are_written_in_every_form() {
    let [json, csv, html] = ["check.json", "check.csv", "check.html"].map(file);
    let paths = [&json, &csv, &html].map(|p| p.to_str().unwrap());
    let output = check(&[
        "--quick", "--only", "at rest", "--json", paths[0], "--csv", paths[1], "--html", paths[2],
    ]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(output.stderr.is_empty());
    assert!(text.contains("pendulum at rest, hanging") && text.contains("3 rows: 3 pass"));

    let document: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    assert_eq!(document["summary"]["rows"], 3);
    assert_eq!(document["summary"]["failed"], 0);
    assert_eq!(document["summary"]["known_deficits"], 0);
    let rows = document["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 3);
    for row in rows {
        assert_eq!(row["theme"], "degenerate");
        assert_eq!(row["steps"], row["steps_wanted"]);
        let outcomes = row["outcomes"].as_object().unwrap().values();
        assert_eq!(outcomes.map(|n| n.as_u64().unwrap()).sum::<u64>(), 100);
        assert_eq!(row["verdict"], "pass");
    }

    assert_eq!(std::fs::read_to_string(&csv).unwrap().lines().count(), 4);
    let page = std::fs::read_to_string(&html).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    assert_eq!(page.matches("<tr class=\"pass\">").count(), 3);
    assert!(
        !page.contains("src=") && !page.contains("href="),
        "needs nothing else"
    );
}

/// A row that is known to fail is a verdict of its own: listed last, with its figure, and no failure.
#[test]
fn a_known_deficit_has_its_figure_and_does_not_fail() {
    let output = check(&["--quick", "--only", "FPUT chain, m=2 s=4"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    let end = text.split("slowest row").nth(1).unwrap();
    assert!(end.contains("known deficit FPUT chain, m=2"), "{text}");
    assert!(end.contains("3 allowed; 11 is known"), "{text}");
    assert!(
        end.contains("1 rows: 0 pass, 0 expected errors, 0 explained, 1 known deficits, 0 fail")
    );
    let help = String::from_utf8(check(&["--help"]).stdout).unwrap();
    // Lines are wrapped.
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("at most 3 times that of Gauss") && help.contains("known deficit"));
}

/// The whole of `equip check --quick`, so that no row is lost unnoticed.
#[test]
#[ignore = "long: .ci/long runs it"]
fn every_row_of_the_quick_catalogue_holds_or_is_explained_or_known() {
    let output = check(&["--quick"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
}

#[test]
fn escape_to_infinity_is_reported_with_the_steps_before_it() {
    let json = file("check-escape.json");
    let output = check(&[
        "--only",
        "E=0.245, escape",
        "--json",
        json.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0));
    let document: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    for row in document["rows"].as_array().unwrap() {
        assert_eq!(row["verdict"], "expected error");
        assert!(row["steps"].as_u64().unwrap() > 50);
        assert!(row["ended_with"].as_str().unwrap().contains("t = 5."));
    }
}

/// Near underflow the round-off of H is not relative to H: a floor that is would ask for digits H does
/// not have.
#[test]
fn an_energy_among_the_subnormal_numbers_keeps_the_trajectory() {
    let output = check(&["--only", "2^-1062"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
}

#[test]
fn nothing_selected_is_bad_usage() {
    let output = check(&["--only", "no such row"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("--only"));
}

#[test]
fn a_path_that_cannot_be_written_is_told_before_the_work() {
    let output = check(&["--json", "no/such/directory/check.json"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stdout.is_empty());
}
