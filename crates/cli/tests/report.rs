//! `equip report` on one small scene.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

use std::path::PathBuf;
use std::process::{Command, Output};

fn report(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_equip"))
        .arg("report")
        .args(arguments)
        .output()
        .unwrap()
}

fn directory(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// A file as `benches/peers` writes it, cut down.
const PEERS: &str = r#"{"version": 1, "cpu": "a <fast> one", "versions": {"heyoka": "7.13.2", "other": null}, "scenes": [{"scene": "kepler-0.6", "title": "Kepler e = 0.6",
    "end": 1.0, "targets": [1e-6, 1e-8], "reference_within": 1e-27,
    "programs": [
        {"program": "heyoka", "reached": [{"target": 1e-6, "method": "default", "setting": 1e-9, "error": 1e-7, "milliseconds": 2.0,
            "least": 1.9, "most": 2.1, "rounds": 3, "ratio_to_quickest_peer": 1.0}, null]},
        {"program": "equip by hand", "reached": [{"target": 1e-6, "method": "trait, s = 8", "setting": 100, "error": 1e-7,
            "milliseconds": 1.0, "least": 0.9, "most": 1.1, "rounds": 3, "ratio_to_quickest_peer": 0.5}, null]}],
    "at_tolerance": {"tolerance": 1e-14, "rows": [{"program": "heyoka", "method": "default", "error": 3e-3, "milliseconds": 1.5,
        "least": 1.4, "most": 1.6}]},
    "curves": [{"program": "heyoka", "method": "default", "points": [{"setting": 1e-9, "error": 1e-7, "milliseconds": 2.0}]},
        {"program": "equip by hand", "method": "trait, s = 8", "points": [{"setting": 100, "error": null, "milliseconds": null}]}]}]}"#;

#[test]
fn a_page_with_pictures_and_tables_that_agree_with_each_other() {
    let out = directory("report");
    std::fs::create_dir_all(&out).unwrap();
    let peers = out.join("peers.json");
    std::fs::write(&peers, PEERS).unwrap();
    let (out_text, peers) = (out.to_str().unwrap(), peers.to_str().unwrap());
    let arguments = [
        "--quick",
        "--only",
        "kepler-0.6-f64",
        "--seconds",
        "6",
        "--out",
        out_text,
        "--peers",
        peers,
    ];
    let output = report(&arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{error}");
    assert!(error.is_empty(), "{error}");

    let runs = std::fs::read_to_string(out.join("runs.csv")).unwrap();
    let lines: Vec<&str> = runs.lines().collect();
    let columns = lines[0].split(',').count();
    for method in ["EQUIP(4)", "EQUIP(8)", "Gauss(8)"] {
        let rows: Vec<Vec<&str>> = lines
            .iter()
            .map(|l| l.split(',').collect::<Vec<_>>())
            .filter(|cells| cells[2] == method)
            .collect();
        // How many settings are run depends on the machine.
        assert!(rows.len() >= 2, "{method}: {} rows", rows.len());
        let number = |row: &Vec<&str>, i: usize| row[i].parse::<f64>().unwrap();
        let error = |row: &Vec<&str>| number(row, 6);
        let best = rows.iter().map(error).fold(f64::INFINITY, f64::min);
        // Finer settings are better, here with room for machines on which the time is up after the second.
        assert!(
            error(&rows[0]) > 2.0 * best,
            "{method}: {:e} to {best:e}",
            error(&rows[0])
        );
        for row in &rows {
            assert_eq!(row.len(), columns, "{row:?}");
            assert!(row[8].contains("angular momentum="), "{row:?}");
            assert!(
                number(row, 11) > 0.0 && number(row, 12) <= number(row, 11),
                "{row:?}"
            );
        }
        if method == "EQUIP(4)" {
            // Energy at round-off where the motion is followed to 1e-3: measured 3.1e-14 at most, headroom
            // of 10.
            let is_kept = rows
                .iter()
                .all(|row| number(row, 6) > 1e-3 || number(row, 7) < 3e-13);
            assert!(is_kept, "{rows:?}");
        }
    }

    let times = std::fs::read_to_string(out.join("times.csv")).unwrap();
    // EQUIP and Gauss, each with 3 numbers of stages and with step control; 4 targets; a header.
    assert_eq!(times.lines().count(), 1 + 8 * 4);
    assert!(
        times
            .lines()
            .any(|l| l.starts_with("kepler-0.6,f64,Gauss(4),1e-6,") && l.ends_with("interpolated"))
    );

    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    // The conclusion has the range of the times of EQUIP over those of Gauss with as many stages.
    let interpolated = |method: &str, target: &str| -> Option<f64> {
        let start = format!("kepler-0.6,f64,{method},{target},");
        let line = times.lines().find(|line| line.starts_with(&start))?;
        let time = line[start.len()..].strip_suffix(",interpolated")?;
        time.parse().ok()
    };
    let mut ratios = Vec::new();
    for method in ["(4)", "(6)", "(8)", "(8) step control"] {
        for target in ["1e-6", "1e-8", "1e-10", "1e-12"] {
            let time = |name| interpolated(&format!("{name}{method}"), target);
            ratios.extend(
                time("EQUIP")
                    .zip(time("Gauss"))
                    .map(|(ours, theirs)| ours / theirs),
            );
        }
    }
    let (low, high) = ratios
        .iter()
        .fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), x| {
            (low.min(*x), high.max(*x))
        });
    let conclusion = page.split("class=\"conclusion\"").nth(1).unwrap();
    let conclusion = conclusion.split("</ol>").next().unwrap();
    let expected = if ratios.is_empty() {
        "cannot be compared".to_owned()
    } else {
        format!("{low:.2} to {high:.2} times")
    };
    assert!(conclusion.contains(&expected), "{conclusion}: {expected}");
    assert_eq!(conclusion.matches("<li>").count(), 1);
    // The column of uncorrected steps is the last.
    assert!(lines[0].ends_with(",uncorrected"));
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    assert!(
        !page.contains("src=") && page.matches("href=").count() == page.matches("href=\"#").count(),
        "needs nothing else"
    );
    assert!(!page.contains("NaN") && !page.contains(">inf"));
    assert_eq!(page.matches("<figure").count(), 2);
    assert!(page.contains("Laplace-Runge-Lenz x"));
    assert!(
        page.contains("Compared with other programs")
            && page.contains("(0.50)")
            && page.contains("heyoka 7.13.2</p>")
            && page.contains("All at tolerance 1e-14")
            && page.contains("a &lt;fast&gt; one")
    );
    for name in ["kepler-0.6-f64.svg", "peers-kepler-0.6.svg"] {
        let svg = std::fs::read_to_string(out.join(name)).unwrap();
        assert!(
            svg.starts_with("<svg")
                && svg.ends_with("</svg>\n")
                && !svg.contains("NaN")
                && !svg.contains("inf")
        );
    }
}

#[test]
fn long_runs_come_first() {
    let out = directory("report-long");
    let output = report(&[
        "--quick",
        "--only",
        "long-runs",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).unwrap();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    // Measured: 5e-12 and 2.5e-10.
    assert!(
        text.contains("1000 revolutions")
            && text.contains("that of EQUIP is smaller by a factor of"),
        "{text}"
    );
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("uncorrected steps") && !page.contains("NaN"));
    assert!(
        std::fs::read_to_string(out.join("long-runs.csv"))
            .unwrap()
            .contains("0.6,1e-12,Gauss,1000.3,")
    );
    assert!(out.join("long-runs.svg").exists());
}

#[test]
fn columns_a_scene_does_not_have_are_left_out() {
    let out = directory("report-double-pendulum");
    let out_text = out.to_str().unwrap();
    let output = report(&[
        "--only",
        "double-pendulum",
        "--seconds",
        "2",
        "--out",
        out_text,
    ]);
    assert_eq!(output.status.code(), Some(0));
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    // No invariant besides H.
    assert!(!page.contains("momentum") && page.contains("Gauss(8)"));
}

#[test]
fn bad_usage_is_told_before_the_work() {
    let told = |arguments: &[&str], code: i32, hint: &str| {
        let output = report(arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{error}");
        assert!(error.contains(hint), "{error}");
    };
    told(&["--only", "no such scene"], 2, "--only");
    told(&["--seconds", "0"], 2, "positive");
    told(&["--peers", "Cargo.toml"], 2, "peers.json");
    let peers = directory("unprintable.json");
    for title in ["a\\u0000b", "a\\nb", &"a".repeat(300)] {
        std::fs::write(&peers, PEERS.replace("Kepler e = 0.6", title)).unwrap();
        told(&["--peers", peers.to_str().unwrap()], 2, "peers.json");
    }
    // Another program writes to the directory.
    let busy = directory("report-busy");
    std::fs::create_dir_all(&busy).unwrap();
    let lock = std::fs::File::create(busy.join("report.html.lock")).unwrap();
    lock.lock().unwrap();
    let words = "report.html is being written by another program";
    told(&["--out", busy.to_str().unwrap()], 2, words);
    let file = directory("a-file");
    std::fs::write(&file, "").unwrap();
    told(
        &["--only", "pendulum-f64", "--out", file.to_str().unwrap()],
        1,
        "cannot write",
    );
}
