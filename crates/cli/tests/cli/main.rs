//! The program as its user meets it: what it prints, what it writes, and how it ends.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

mod failures;
mod help;
mod killed;
mod pictures;
#[cfg(unix)]
mod printed;
mod refused;
mod tables;

use std::path::PathBuf;
use std::process::{Command, Output};

fn equip(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_equip"))
        .args(arguments)
        .output()
        .unwrap()
}

/// Standard output of a command that must succeed.
fn stdout(arguments: &[&str]) -> String {
    let output = equip(arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {error}");
    assert!(error.is_empty(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a command that must end with `code`.
fn failure(code: i32, arguments: &[&str]) -> String {
    let output = equip(arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// A file of this test alone.
fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// The cells of a table, row by row, its header first.
fn table(path: &PathBuf) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap();
    let cells = |row: &str| row.split(',').map(str::to_owned).collect();
    text.lines().map(cells).collect()
}

/// Every element of the SVG is closed in its order, and no number in it is NaN or infinite.
fn well_formed(text: &str) {
    let mut open = Vec::new();
    assert!(text.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
    for element in text.split('<').skip(1) {
        let (tag, content) = element.split_once('>').unwrap();
        assert!(
            !content.contains('>') && tag.matches('"').count() % 2 == 0,
            "{tag}"
        );
        assert!(!tag.contains("NaN") && !tag.contains("inf"), "{tag}");
        let name = tag
            .trim_start_matches('/')
            .split([' ', '/'])
            .next()
            .unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty() && text.ends_with("</svg>\n"));
}
