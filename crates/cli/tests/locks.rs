//! Two programs do not write one file, and a program that was killed blocks none.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A directory of one test alone, empty.
fn directory(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("locks-{name}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn equip(home: &Path, arguments: &str) -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
    program.current_dir(home).args(arguments.split(' '));
    program
}

fn output(home: &Path, arguments: &str) -> (Option<i32>, String) {
    let Output { status, stderr, .. } = equip(home, arguments).output().unwrap();
    (status.code(), String::from_utf8(stderr).unwrap())
}

/// A program that goes on until it is killed, from when these files are there.
struct Running(Child);

impl Running {
    fn start(home: &Path, arguments: &str, files: &[&str]) -> Self {
        let child = equip(home, arguments)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        let is_there = |name: &&str| std::fs::metadata(home.join(name)).is_ok_and(|f| f.len() > 0);
        while !files.iter().all(is_there) {
            assert!(begun.elapsed() < Duration::from_secs(60), "{arguments}");
            std::thread::sleep(Duration::from_millis(5));
        }
        Running(child)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.0.kill().unwrap();
        self.0.wait().unwrap();
    }
}

const LONG: &str = "run kepler --step 1/50 --until 1e9 --every 5000 --quiet";

#[test]
fn a_table_that_is_being_written_is_refused() {
    let home = directory("table");
    let running = Running::start(&home, &format!("{LONG} --out t.csv"), &["t.csv"]);
    std::fs::write(home.join("p.svg"), "precious").unwrap();
    let before = std::fs::metadata(home.join("t.csv")).unwrap().len();
    let (code, error) = output(&home, "run kepler --until 1 --out t.csv --plot p.svg");
    assert_eq!(code, Some(2), "{error}");
    assert!(
        error.contains("t.csv is being written by another program"),
        "{error}"
    );
    assert!(std::fs::metadata(home.join("t.csv")).unwrap().len() >= before);
    assert_eq!(std::fs::read(home.join("p.svg")).unwrap(), b"precious");
    drop(running);
    let (code, error) = output(&home, "run kepler --until 1 --out t.csv --plot p.svg");
    assert_eq!(code, Some(0), "{error}");
}

#[test]
fn a_checkpoint_that_is_being_written_is_refused() {
    let home = directory("checkpoint");
    let long = format!("{LONG} --checkpoint c --checkpoint-every 0.02");
    let running = Running::start(&home, &long, &["c"]);
    for arguments in [
        "run kepler --until 1 --checkpoint c",
        "run kepler --until 1 --checkpoint ./c --out t.csv",
        "run pendulum --checkpoint c",
    ] {
        let (code, error) = output(&home, arguments);
        assert_eq!(code, Some(2), "{error}");
        assert!(
            error.contains("c is being written by another program"),
            "{error}"
        );
        assert!(!home.join("t.csv").exists());
    }
    drop(running);
    // What the killed program leaves behind is no lock.
    assert!(home.join("c.lock").exists());
    drop(Running::start(&home, &long, &["c"]));
    let (code, error) = output(&home, "run kepler --until 1 --checkpoint d");
    assert_eq!((code, error.as_str()), (Some(0), ""));
    assert!(!home.join("d.lock").exists());
    let (code, error) = output(&home, "run kepler --until 1 --checkpoint e --out e.lock");
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("name two files"), "{error}");
}

/// A program that is killed before its result leaves the files of the one before.
#[test]
fn what_is_in_a_file_stays_until_there_is_more() {
    let home = directory("interrupted");
    std::fs::write(home.join("a"), "precious").unwrap();
    for arguments in [
        "check --json a --html opened-by-check",
        "section henon-heiles --orbits 5000 --csv a --plot opened-by-section",
    ] {
        let program = equip(&home, arguments).stdout(Stdio::null()).spawn();
        let running = Running(program.unwrap());
        let (_, last) = arguments.rsplit_once(' ').unwrap();
        while !home.join(last).exists() {
            std::thread::sleep(Duration::from_millis(5));
        }
        drop(running);
        let left = std::fs::read(home.join("a")).unwrap();
        assert_eq!(left, b"precious", "{arguments}");
    }
}
