//! What the command line refuses, and in which words; what it says of options that change nothing; what fits
//! the terminal.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

use std::path::PathBuf;
use std::process::{Command, Output};

fn equip(arguments: &[&str]) -> Output {
    let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("command-line");
    std::fs::create_dir_all(&home).unwrap();
    Command::new(env!("CARGO_BIN_EXE_equip"))
        .current_dir(home)
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).unwrap()
}

/// Standard error of a command that must be refused as bad usage.
fn refused(arguments: &[&str]) -> String {
    let output = equip(arguments);
    let error = text(output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
    error
}

#[test]
fn two_outputs_do_not_go_into_one_file() {
    for pair in [
        ["--out", "x", "--plot", "x"],
        ["--out", "x", "--plot", "./x"],
        ["--plot", "x", "--checkpoint", "../command-line/x"],
        ["--out", "x", "--checkpoint", "x"],
    ] {
        let error = refused(&[&["run", "kepler", "--until", "1"][..], &pair].concat());
        assert!(
            error.contains(pair[0]) && error.contains(pair[2]),
            "{error}"
        );
        assert!(error.contains("name two files"), "{error}");
    }
    // A checkpoint is written to a file beside it first.
    let error = refused(&[
        "run",
        "kepler",
        "--until",
        "1",
        "--checkpoint",
        "x",
        "--out",
        "./x.new",
    ]);
    assert!(error.contains("while it is written"), "{error}");
    for command in [
        "growth --revolutions 1 --plot x --csv x",
        "section henon-heiles --orbits 1 --until 1 --plot x --csv ./x",
        "check --only rest --json x --csv x",
        "check --only rest --json x --html ./x",
        "check --only rest --csv x --html x",
    ] {
        let error = refused(&command.split(' ').collect::<Vec<_>>());
        assert!(error.contains("name two files"), "{command}: {error}");
    }
}

#[test]
fn pictures_of_other_formats_are_refused() {
    for command in ["run kepler", "growth", "section henon-heiles"] {
        for name in ["k.png", "k.PDF"] {
            let arguments = [
                &command.split(' ').collect::<Vec<_>>()[..],
                &["--plot", name],
            ];
            let error = refused(&arguments.concat());
            assert!(error.contains(".svg or .html"), "{error}");
        }
    }
}

/// The files of long commands are made when the first part of the work is done: a path that cannot be written
/// costs no hour, and bad input costs no file.
#[test]
fn files_are_made_early_but_not_for_bad_input() {
    let home = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("command-line");
    std::fs::create_dir_all(&home).unwrap();
    for command in [
        "growth --revolutions 1",
        "section henon-heiles --orbits 1 --until 1",
    ] {
        let run = |more: &str| {
            let all: Vec<&str> = command.split(' ').chain(more.split(' ')).collect();
            equip(&all)
        };
        std::fs::write(home.join("precious"), "precious").unwrap();
        let bad = run("--stages 99 --plot precious");
        assert_eq!(bad.status.code(), Some(2));
        assert_eq!(std::fs::read(home.join("precious")).unwrap(), b"precious");
        let unwritten = run("--plot no/such/directory");
        assert_eq!(unwritten.status.code(), Some(1));
        assert!(text(unwritten.stderr).contains("no/such/directory"));
        // `growth` prints a row for each run, and is told before the first.
        assert!(!text(unwritten.stdout).contains("EQUIP"), "{command}");
    }
}

#[test]
fn negative_values_meet_the_range_they_are_out_of() {
    for (command, option, words) in [
        (
            "run kepler",
            "--stages",
            "a whole number in the range of the method",
        ),
        ("run kepler", "--step", "without a sign"),
        ("run kepler", "--steps-per-period", "positive"),
        ("run kepler", "--tolerance", "--tolerance is"),
        ("run kepler", "--every", "a whole number"),
        (
            "run kepler --checkpoint negative",
            "--checkpoint-every",
            "from 0 to 1e18",
        ),
        ("run kepler", "--e", "out of range"),
        ("growth", "--tolerances", "--tolerances is -1; it must be"),
        ("growth", "--eccentricities", "out of range"),
        ("growth", "--revolutions", "a whole number"),
        (
            "growth",
            "--stages",
            "a whole number in the range of the method",
        ),
        ("section henon-heiles", "--orbits", "a whole number"),
        ("section henon-heiles", "--tolerance", "--tolerance is"),
        ("section henon-heiles", "--energy", "out of range"),
        ("report", "--seconds", "a positive number of seconds"),
    ] {
        let arguments: Vec<&str> = command.split(' ').chain([option, "-1"]).collect();
        let error = refused(&arguments);
        assert!(error.contains(words), "{command} {option} -1: {error}");
    }
}

#[test]
fn values_that_are_no_numbers_or_too_large_meet_their_range() {
    for (command, words) in [
        (
            "run kepler --steps-per-period nan",
            "--steps-per-period is nan; it must be positive and finite",
        ),
        (
            "run kepler --steps-per-period inf",
            "--steps-per-period is inf",
        ),
        (
            "run kepler --checkpoint huge --checkpoint-every 1e300",
            "it must be a number of seconds from 0 to 1e18",
        ),
        ("run kepler --tolerance 1e-300", "--tolerance is 1e-300"),
        (
            "section henon-heiles --until nan",
            "--until is nan; it must be finite",
        ),
        ("growth --tolerances 1e-30", "--tolerances is 1e-30"),
    ] {
        let error = refused(&command.split(' ').collect::<Vec<_>>());
        assert!(error.contains(words), "{command}: {error}");
        assert!(
            error.lines().all(|line| line.chars().count() < 200),
            "{error}"
        );
    }
    // An error inside a step of any size.
    let output = equip(&["run", "kepler", "--step", "1e300", "--until", "1e301"]);
    let error = text(output.stderr);
    assert!(
        error.contains("e296") && !error.contains("00000"),
        "{error}"
    );
    // A run of no length has no error to aim at.
    let output = equip(&["run", "kepler", "--target-error", "1e-8", "--until", "0"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(output.stderr));
}

#[test]
fn numbers_of_orbits_that_cannot_be_drawn_are_refused_at_once() {
    for orbits in ["0", "100000000", "18446744073709551615"] {
        let error = refused(&["section", "henon-heiles", "--orbits", orbits]);
        assert!(error.contains("a whole number"), "{orbits}: {error}");
    }
}

#[test]
fn growth_reads_its_lists_before_it_begins() {
    for lists in [
        ["--eccentricities", "0.6,1.5"],
        ["--tolerances", "1e-9,0"],
        ["--tolerances", "1e-9,2"],
        ["--tolerances", "1e-9,1e-30"],
        ["--tolerances", "1e-1,1e-2,1e-3,1e-4,1e-5,1e-6,1e-7"],
        ["--stages", "1"],
    ] {
        let output = equip(&[&["growth", "--revolutions", "1"][..], &lists].concat());
        assert_eq!(output.status.code(), Some(2), "{lists:?}");
        assert!(output.stdout.is_empty(), "{lists:?}");
    }
}

#[test]
fn options_that_change_nothing_are_named() {
    for (options, words) in [
        (
            &["--every", "5"][..],
            "--every has no effect: there is no --out",
        ),
        (
            &["--no-compare"],
            "--no-compare has no effect: there is no --plot",
        ),
        (
            &["--alpha-policy", "refuse", "--method", "gauss"],
            "--alpha-policy has no effect",
        ),
    ] {
        let output = equip(&[&["run", "kepler", "--until", "1"][..], options].concat());
        assert_eq!(output.status.code(), Some(0));
        let error = text(output.stderr);
        assert!(error.contains(words), "{options:?}: {error}");
    }
    // --quiet leaves out the certificate and the progress, not what a user has to know.
    for (option, words) in [
        ("--every=5", "--every has no effect"),
        ("--lyapunov", "--lyapunov has no effect: with --quiet"),
    ] {
        let quiet = equip(&["run", "kepler", "--until", "1", "--quiet", option]);
        assert!(text(quiet.stderr).contains(words), "{option}");
        assert!(quiet.stdout.is_empty());
    }
    let quiet = equip(&["run", "kepler", "--until", "1", "--quiet"]);
    assert!(quiet.stderr.is_empty() && quiet.stdout.is_empty());
}

#[test]
fn messages_name_flags() {
    for (arguments, flag) in [
        (
            &["run", "kepler", "--stages", "1"][..],
            "--stages, or a number in --method, is 1",
        ),
        (
            &["run", "kepler", "--stages", "0"],
            "is 0; this method accepts 2 to 32",
        ),
        (
            &[
                "run", "kepler", "--stages", "0", "--method", "gauss", "--step", "1",
            ],
            "is 0; this method accepts 1 to 32",
        ),
        (
            &["growth", "--stages", "0"],
            "is 0; this method accepts 2 to 32",
        ),
        (&["run", "kepler", "--tolerance", "2"], "--tolerance is 2"),
        (&["run", "kepler", "--step", "0"], "--step is 0"),
        (
            &["run", "kepler", "--target-error", "-1"],
            "--target-error is -1",
        ),
        (
            &["run", "kepler", "--target-error", "nan"],
            "--target-error is nan",
        ),
        (
            &["run", "kepler", "--method", "fixed-alpha=inf"],
            "--method fixed-alpha is inf",
        ),
    ] {
        let error = refused(arguments);
        assert!(error.contains(flag) && !error.contains('`'), "{error}");
    }
}

#[test]
fn lists_fit_the_terminal() {
    let mut all = vec![equip(&["scenes"])];
    all.extend(
        equip_scenes::all()
            .iter()
            .map(|scene| equip(&["scenes", scene.name])),
    );
    all.push(equip(&["check", "--quick", "--only", "at rest"]));
    for output in all {
        for line in text(output.stdout).lines() {
            assert!(line.chars().count() <= 100, "{line}");
        }
    }
}

#[test]
fn short_times_are_printed_with_their_digits() {
    let output = equip(&["run", "harmonic", "--omega", "1e6", "--periods", "3"]);
    let printed = text(output.stdout);
    let line = |label: &str| {
        printed
            .lines()
            .find(|line| line.starts_with(label))
            .unwrap()
    };
    assert!(line("time ").contains("e-5"), "{printed}");
    assert!(line("steps ").contains("e-"), "{printed}");
    let slow = text(equip(&["run", "harmonic", "--omega", "1e-300", "--until", "1"]).stdout);
    let longest = slow.lines().map(|line| line.chars().count()).max();
    assert!(longest < Some(100), "{slow}");
    let described = text(equip(&["scenes", "lotka-volterra"]).stdout);
    assert!(!described.contains("0.0000"), "{described}");
}

/// Steps over springs: the text and the document say so, in the same words.
#[test]
fn steps_that_resolve_nothing_are_named() {
    let run = [
        "run", "fpu", "--omega", "500", "--stages", "4", "--step", "0.1", "--until", "1",
    ];
    let printed = text(equip(&run).stdout);
    assert!(
        printed.contains("not resolved") && printed.contains("h ω = "),
        "{printed}"
    );
    let json = text(equip(&[&run[..], &["--json"]].concat()).stdout);
    let document: serde_json::Value = serde_json::from_str(&json).unwrap();
    // The same verdict comes first in both.
    let verdict = document["energy_conserved_to_round_off"].as_str().unwrap();
    assert!(verdict.starts_with("NO: ") && verdict.contains("steps uncorrected, largest error "));
    let first = format!("energy conserved to round-off: {verdict}\n");
    assert!(printed.starts_with(&first), "{printed}");
    assert!(
        json.starts_with("{\n  \"energy_conserved_to_round_off\": \"NO: "),
        "{json}"
    );
    assert_eq!(document["motion_is_resolved"], false);
    let angle = document["phase_per_step"]["angle"].as_f64().unwrap();
    assert!((angle - 50.0).abs() < 1.0, "{angle}");
    assert_eq!(document["energy_round_off"]["is_small"], true);
    for count in ["simplified_factorisations", "local_errors", "output_steps"] {
        assert!(document["work"][count].is_u64(), "{count}");
    }
}
