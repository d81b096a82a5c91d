//! A run that is killed and gone on with is the run that was left alone.

use crate::{equip, file};
use std::path::PathBuf;
use std::process::Command;

/// Runs with a checkpoint at every step, kills the program in the middle, goes on, and compares the table
/// with that of a run that was left alone.
fn killed_and_gone_on(name: &str, signal: &str, arguments: &[&str]) {
    let (out, whole) = (
        file(&format!("{name}.csv")),
        file(&format!("{name}-whole.csv")),
    );
    let checkpoint = file(&format!("{name}.checkpoint"));
    let _ = std::fs::remove_file(&checkpoint);
    let with = |out: &PathBuf, more: &[&str]| {
        let mut all: Vec<String> = arguments.iter().map(|x| x.to_string()).collect();
        all.extend(["--out".into(), out.to_str().unwrap().into()]);
        all.extend(more.iter().map(|x| x.to_string()));
        all
    };
    let save = [
        "--checkpoint",
        checkpoint.to_str().unwrap(),
        "--checkpoint-every",
        "0.05",
    ];
    let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
    let program = program.args(with(&out, &save)).arg("--json");
    let mut child = program
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // Killed as soon as there is a second checkpoint, so in the middle of writing something.
    let written = || {
        std::fs::metadata(&checkpoint)
            .and_then(|file| file.modified())
            .ok()
    };
    let begun = std::time::Instant::now();
    let mut first = None;
    while begun.elapsed().as_secs() < 60 {
        let now = written();
        if first.is_none() {
            first = now;
        } else if now.is_some() && now != first {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let id = child.id().to_string();
    Command::new("kill").args([signal, &id]).status().unwrap();
    let ended = child.wait().unwrap();
    assert!(!ended.success(), "the run was over before it was killed");
    let number = match signal {
        "-INT" => Some(2),
        "-USR1" => Some(10),
        "-XCPU" => Some(24),
        _ => None,
    };
    assert_eq!(ended.code(), number.map(|number| 128 + number));
    if let (Some(number), Some(stderr)) = (number, child.stderr.take()) {
        let message = std::io::read_to_string(stderr).unwrap();
        let words = format!("ended by signal {number} at t = ");
        assert!(message.contains(&words), "{message}");
        assert!(message.contains("the same command resumes"), "{message}");
        let printed = std::io::read_to_string(child.stdout.take().unwrap()).unwrap();
        let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
        assert_eq!(json["error"], format!("ended by signal {number}"));
    }
    let output = equip(
        &with(&out, &save)
            .iter()
            .map(String::as_str)
            .collect::<Vec<_>>(),
    );
    assert_eq!(output.status.code(), Some(0));
    assert!(
        String::from_utf8(output.stderr)
            .unwrap()
            .contains("resuming at t = ")
    );
    equip(
        &with(&whole, &[])
            .iter()
            .map(String::as_str)
            .collect::<Vec<_>>(),
    );
    let read = |path| std::fs::read_to_string(path).unwrap();
    assert!(read(&out) == read(&whole), "{} differs", out.display());
}

#[test]
#[cfg(unix)]
fn a_killed_run_goes_on_as_if_it_had_not_been() {
    let fixed = [
        "run", "kepler", "--stages", "4", "--step", "1/50", "--until", "15000", "--every", "70",
    ];
    killed_and_gone_on("killed-fixed", "-KILL", &fixed);
    let variable = [
        "run",
        "kepler",
        "--e",
        "0.9",
        "--stages",
        "6",
        "--tolerance",
        "1e-9",
        "--until",
        "20000",
        "--every",
        "50",
    ];
    killed_and_gone_on("killed-variable", "-KILL", &variable);
    killed_and_gone_on("interrupted", "-INT", &variable);
    // As the queue of a cluster does before the time is over, and the system at its limit.
    killed_and_gone_on("queued", "-USR1", &variable);
    killed_and_gone_on("limited", "-XCPU", &variable);
}

/// A run under a limit of the shell.
#[cfg(unix)]
fn limited(limit: &str, arguments: &str) -> std::process::Output {
    let program = env!("CARGO_BIN_EXE_equip");
    let line = format!("ulimit {limit}; exec {program} {arguments}");
    Command::new("sh").args(["-c", &line]).output().unwrap()
}

#[test]
#[cfg(unix)]
fn the_limit_of_processor_time_ends_a_run_with_its_table() {
    let out = file("processor-time.csv");
    let path = out.to_str().unwrap();
    let arguments = format!("run kepler -q --step 1/50 --until 1e8 --every 1000 --out {path}");
    let output = limited("-S -t 1", &arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(128 + 24), "{message}");
    let (_, reached) = message.split_once("ended by signal 24 at t = ").unwrap();
    let reached: f64 = reached.split(';').next().unwrap().parse().unwrap();
    let rows = crate::table(&out);
    let last: f64 = rows[rows.len() - 1][0].parse().unwrap();
    assert!((last / reached - 1.0).abs() < 1e-6, "{last} {reached}");
}

#[test]
#[cfg(unix)]
fn a_file_at_the_limit_of_its_size_is_named_and_the_run_goes_on_later() {
    let (out, whole) = (file("size.csv"), file("size-whole.csv"));
    let checkpoint = file("size.checkpoint");
    let _ = std::fs::remove_file(&checkpoint);
    let run = |out: &PathBuf| {
        format!(
            "run kepler -q --step 1/50 --until 600 --out {}",
            out.display()
        )
    };
    let with = format!(
        "{} --checkpoint {} --checkpoint-every 0.01",
        run(&out),
        checkpoint.display()
    );
    // 2 MB of the 3 MB of the table, in blocks of 512 bytes or of 1024.
    let output = limited("-f 2000", &with);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("cannot write all of") && message.contains("ulimit -f"));
    assert!(
        message.contains("size.csv") && message.contains("--every"),
        "{message}"
    );
    for arguments in [&with, &run(&whole)] {
        assert!(limited("-S -c 0", arguments).status.success());
    }
    let read = |path| std::fs::read_to_string(path).unwrap();
    assert!(read(&out) == read(&whole), "another table");
}

/// Of every command, and with advice that the command can follow.
#[test]
#[cfg(unix)]
fn a_file_that_does_not_fit_is_named() {
    let path = |name: &str| file(name).display().to_string();
    let (plot, checkpoint) = (path("small.svg"), path("small.checkpoint"));
    for (arguments, name) in [
        ("section henon-heiles --orbits 2 --until 50 --plot", &plot),
        (
            "growth --revolutions 1 --eccentricities 0.6 --tolerances 1e-9 --plot",
            &plot,
        ),
        ("check --only hanging --html", &plot),
        ("paper --html", &plot),
        ("run kepler --until 1 --plot", &plot),
        ("run kepler --until 1 --checkpoint", &checkpoint),
    ] {
        let output = limited("-f 1", &format!("{arguments} {name}"));
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments}: {message}");
        let words = format!("cannot write all of {name}: ");
        assert!(
            message.contains(&words) && !message.contains("--every"),
            "{message}"
        );
    }
    assert!(!file("small.checkpoint.new").exists());
}
