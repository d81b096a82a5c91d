//! `equip paper`: every statement holds, with the figures of an independent program in quadruple precision.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

use serde_json::Value;
use std::path::PathBuf;
use std::process::Command;

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Errors after two periods, 80, 160 and 320 steps a period: Gauss, α = 0.02, the solved α.
const ERRORS: [(u64, [[f64; 3]; 3]); 3] = [
    (
        2,
        [
            [5.872e-3, 3.906e-4, 2.476e-5],
            [7.98e-1, 2.27e-1, 5.72e-2],
            [5.330e-4, 3.354e-5, 2.100e-6],
        ],
    ),
    (
        3,
        [
            [6.581e-5, 9.952e-7, 1.544e-8],
            [5.26e-3, 3.32e-4, 2.08e-5],
            [1.728e-6, 2.742e-8, 4.279e-10],
        ],
    ),
    (
        4,
        [
            [3.122e-8, 1.961e-10, 8.217e-13],
            [2.44e-5, 3.84e-7, 6.01e-9],
            [1.088e-8, 4.312e-11, 1.691e-13],
        ],
    ),
];
/// The largest |α| of a step at these numbers of steps, s = 2.
const ALPHAS: [f64; 3] = [4.92e-4, 1.24e-4, 3.09e-5];

#[test]
fn every_statement_holds_with_the_figures_of_another_program() {
    let (json, html) = (file("paper.json"), file("paper.html"));
    let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
    let program = program.arg("paper").arg("--json").arg(&json);
    let output = program.arg("--html").arg(&html).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(text.contains("order with g(α, h) = 0, s = 4") && !text.contains("  NO"));

    let paper: Value = serde_json::from_slice(&std::fs::read(&json).unwrap()).unwrap();
    let within = |found: &Value, expected: f64, part: f64| {
        let found = found.as_f64().unwrap();
        assert!(
            (found.abs() / expected - 1.0).abs() < part,
            "{found:e} where {expected:e} is right"
        );
    };
    let rows = paper["convergence"].as_array().unwrap();
    for (stages, errors) in ERRORS {
        for (method, errors) in ["Gauss", "Fixed", "Solved"].iter().zip(errors) {
            let is_it = |row: &&Value| row["stages"] == stages && row["method"] == *method;
            let row = rows.iter().find(is_it).unwrap();
            for (k, error) in errors.into_iter().enumerate() {
                within(&row["errors"][k], error, 0.01);
            }
        }
    }
    let solved = |row: &&Value| row["stages"] == 2 && row["method"] == "Solved";
    let alphas = &rows.iter().find(solved).unwrap()["alphas"];
    for (k, alpha) in ALPHAS.into_iter().enumerate() {
        within(&alphas[k], alpha, 0.01);
    }
    let largest = |k: usize| alphas[k].as_f64().unwrap();
    let root = |k: usize| paper["residual"]["curves"][k]["root"].as_f64().unwrap();
    for rate in [largest(1) / largest(2), root(1) / root(2)] {
        assert!((rate.log2() - 2.0).abs() < 0.05, "{rate}");
    }

    // 200 steps a period, two stages: what rounding makes of 200 000 steps is a part of the energy errors.
    let orbits = paper["orbits"].as_array().unwrap();
    within(&orbits[0]["error"], 8.05e-2, 0.01);
    within(&orbits[0]["energy"], 6.2e-7, 0.01);
    within(&orbits[1]["error"], 6.88e-3, 0.01);
    assert!(orbits[1]["energy"].as_f64().unwrap() < 1e-14);

    let statements = paper["statements"].as_array().unwrap();
    assert!(statements.len() > 20 && statements.iter().all(|s| s["holds"] == true));
    let page = std::fs::read_to_string(&html).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    assert_eq!(page.matches("<figure").count(), 3);
    assert!(!page.contains("NaN") && !page.contains("src="));
    for statement in statements {
        let words = statement["statement"].as_str().unwrap();
        assert!(text.contains(words) && page.contains(words), "{words}");
    }
}
