//! All Rust files of the workspace as text.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

use std::path::{Path, PathBuf};

/// All files `*.rs` below a folder, those that a build made excepted.
pub(super) fn rust_files(below: &Path) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![below.to_path_buf()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let is_built = path.ends_with("target");
            if path.is_dir() && !is_built {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// The comment lines of more than so many columns, counted from 1. Rows of tables and displayed formulas are
/// no prose, and cannot be broken.
pub(super) fn wide_comments(text: &str, columns: usize) -> Vec<usize> {
    let (mut wide, mut in_formula) = (Vec::new(), false);
    for (i, line) in text.lines().enumerate() {
        let Some(comment) = line.trim_start().strip_prefix("//") else {
            in_formula = false;
            continue;
        };
        let comment = comment.trim_start_matches(['/', '!']).trim();
        let opens_or_closes = comment.matches("$$").count() % 2 == 1;
        let is_formula = in_formula || comment.contains("$$");
        in_formula ^= opens_or_closes;
        if line.chars().count() > columns && !is_formula && !comment.starts_with('|') {
            wide.push(i + 1);
        }
    }
    wide
}
