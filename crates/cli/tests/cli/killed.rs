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
    let program = program.args(with(&out, &save)).arg("--quiet");
    let mut child = program
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
    if signal == "-INT" {
        assert_eq!(ended.code(), Some(130));
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
}
