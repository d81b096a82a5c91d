//! Checkpoints that a run does not go on from: nothing is dropped, and what is said is only why.

use crate::file;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A directory of one test alone, empty.
fn directory(name: &str) -> PathBuf {
    let path = file(&format!("refused-{name}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// Exit code and standard error of `equip run kepler` with the checkpoint c in the directory.
fn run(home: &Path, more: &[&str]) -> (Option<i32>, String) {
    let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
    program.current_dir(home);
    program.args(["run", "kepler", "--checkpoint", "c"]);
    let output = program.args(more).output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    (output.status.code(), text)
}

#[test]
fn a_run_with_a_tangent_vector_does_not_go_on_without() {
    let home = directory("tangent_vector");
    assert_eq!(run(&home, &["--until", "2", "--lyapunov"]).0, Some(0));
    let (code, text) = run(&home, &["--until", "3"]);
    assert_eq!(code, Some(2), "{text}");
    assert!(
        text.contains("was made with --lyapunov, this run lacks it"),
        "{text}"
    );
    assert_eq!(run(&home, &["--until", "3", "--lyapunov"]).0, Some(0));
}

#[test]
fn a_refused_run_does_not_say_that_it_goes_on() {
    let home = directory("words");
    let table = ["--out", "t.csv"];
    let first = run(&home, &[&table[..], &["--until", "5"]].concat());
    assert_eq!(first.0, Some(0));
    let read = || std::fs::read(home.join("t.csv")).unwrap();
    let before = read();
    let until = ["--until", "9"];
    for more in [
        &["--stages", "6"][..],
        &["--method", "gauss"],
        &["--tolerance", "1e-9"],
        &["--precision", "dd"],
        &["--plot", "no/such/directory/p.svg"],
        &[],
    ] {
        // The last one ends before the checkpoint.
        let until = if more.is_empty() {
            &["--until", "1"]
        } else {
            &until
        };
        let (code, text) = run(&home, &[&table[..], until, more].concat());
        assert_ne!(code, Some(0), "{more:?}");
        assert!(!text.contains("resuming"), "{more:?}: {text}");
        assert!(read() == before, "{more:?}");
    }
    let (code, text) = run(&home, &[&table[..], &until].concat());
    assert!(
        code == Some(0) && text.contains("resuming at t = "),
        "{text}"
    );
}

#[test]
#[cfg(unix)]
fn a_link_to_a_checkpoint_is_no_second_one() {
    let home = directory("link");
    let link = |target: &str| std::os::unix::fs::symlink(target, home.join("c")).unwrap();
    // The file that the link leads to is not there at first.
    std::fs::create_dir(home.join("far")).unwrap();
    link("far/real");
    for until in ["1", "2"] {
        let (code, text) = run(&home, &["--until", until]);
        assert_eq!(code, Some(0), "{text}");
        assert_eq!(text.contains("resuming"), until == "2", "{text}");
        assert!(home.join("c").is_symlink() && home.join("far/real").is_file());
    }
    let lock = std::fs::File::create(home.join("far/real.lock")).unwrap();
    lock.lock().unwrap();
    let (code, text) = run(&home, &["--until", "3"]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("far/real is being written"), "{text}");
    std::fs::remove_file(home.join("c")).unwrap();
    link("c");
    let (code, text) = run(&home, &["--until", "3"]);
    assert_eq!(code, Some(2), "{text}");
}

#[test]
#[cfg(unix)]
fn what_is_beside_a_checkpoint_is_an_ordinary_file() {
    let home = directory("beside");
    for name in ["c.new", "c.lock"] {
        let path = home.join(name);
        Command::new("mkfifo").arg(&path).status().unwrap();
        let (code, text) = run(&home, &["--until", "1"]);
        assert_eq!(code, Some(2), "{text}");
        let words = format!("--checkpoint is {name}; it must be an ordinary file");
        assert!(text.contains(&words), "{text}");
        std::fs::remove_file(path).unwrap();
    }
    let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
    program.args(["run", "kepler", "--checkpoint", "nowhere/c"]);
    let output = program.output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("cannot write nowhere/c: "), "{text}");
}

#[test]
fn a_checkpoint_of_any_size_is_not_read() {
    let home = directory("size");
    std::fs::write(home.join("c"), "equip checkpoint 2 0000000000000000\n").unwrap();
    let file = std::fs::OpenOptions::new().write(true).open(home.join("c"));
    file.unwrap().set_len(1 << 40).unwrap();
    let (code, text) = run(&home, &["--until", "1"]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("it is larger than 1 GiB"), "{text}");
}
