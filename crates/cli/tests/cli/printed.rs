//! What cannot be printed: a closed pipe hides no fault and stops no work.

use crate::file;
use std::io::pipe;
use std::process::{Child, Command, Stdio};

/// A command whose reader has gone.
fn begun(arguments: &str) -> Child {
    let (reader, writer) = pipe().unwrap();
    drop(reader);
    let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
    let program = program.args(arguments.split(' ')).stdout(writer);
    program.stderr(Stdio::piped()).spawn().unwrap()
}

/// Its exit code and standard error.
fn ended(program: Child) -> (Option<i32>, String) {
    let output = program.wait_with_output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    (output.status.code(), error)
}

#[test]
#[cfg(target_os = "linux")]
fn a_closed_pipe_hides_no_fault() {
    for (arguments, words) in [
        (
            "run kepler --alpha-policy refuse --step .5 --stages 2",
            "no admissible α",
        ),
        ("run kepler --until 1 --out /dev/full", "cannot write all"),
        ("check --only hanging --json /dev/full", "cannot write all"),
        ("paper --json /dev/full", "cannot write all"),
    ] {
        let (code, error) = ended(begun(arguments));
        assert_eq!(code, Some(1), "{arguments}: {error}");
        assert!(error.contains(words), "{arguments}: {error}");
    }
    let plot = file("unread.svg");
    let growth = "growth --revolutions 1 --eccentricities 0.6 --tolerances 1e-9 --plot";
    let (code, error) = ended(begun(&format!("{growth} {}", plot.display())));
    assert_eq!((code, error.as_str()), (Some(0), ""));
    assert!(plot.metadata().unwrap().len() > 0);
    assert_eq!(ended(begun("scenes")), (Some(0), String::new()));
}

#[test]
fn a_closed_pipe_hides_no_signal() {
    let checkpoint = file("unread.checkpoint");
    let _ = std::fs::remove_file(&checkpoint);
    let program = begun(&format!(
        "run kepler --step 1/50 --until 1e9 --json --checkpoint-every 0.02 --checkpoint {}",
        checkpoint.display()
    ));
    while !checkpoint.exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let id = program.id().to_string();
    Command::new("kill").args(["-TERM", &id]).status().unwrap();
    let (code, error) = ended(program);
    assert_eq!(code, Some(143), "{error}");
    assert!(error.contains("the same command resumes from"), "{error}");
}

#[test]
#[cfg(target_os = "linux")]
fn an_output_is_not_written_over_what_is_printed() {
    let path = file("both.txt");
    let name = path.to_str().unwrap();
    let printed = |arguments: &str| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
        program.args(arguments.split(' '));
        program.stdout(std::fs::File::create(&path).unwrap());
        let output = program.output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), error)
    };
    let section = "section henon-heiles --orbits 1 --until 1 --plot /proc/self/fd/1";
    for arguments in [
        "run kepler --until 1 --out /dev/stdout",
        "run kepler --until 1 --json --plot /dev/stdout",
        &format!("run kepler --until 1 --out {name}"),
        "check --only hanging --csv /dev/stdout",
        "paper --json /dev/stdout",
        section,
    ] {
        let (code, error) = printed(arguments);
        assert_eq!(code, Some(2), "{arguments}: {error}");
        let words = "and the standard output name the same file";
        assert!(error.contains(words), "{arguments}: {error}");
    }
    let quiet = printed("run kepler --until 1 --quiet --out /dev/stdout");
    assert_eq!(quiet, (Some(0), String::new()));
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.starts_with("t,q1,q2,"), "{text}");
}
