//! Runs that are stopped, gone on with and repeated: nothing is lost, nothing is written twice, and nothing
//! is mixed up.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A directory of one test alone, empty.
fn directory(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("checkpoints-{name}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

/// `equip run` with table, picture and checkpoint in the directory.
fn command(home: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_equip"));
    command.current_dir(home).arg("run").args(arguments);
    command.args(["--out", "t.csv", "--checkpoint", "c", "--plot", "p.svg"]);
    command
}

fn run(home: &Path, arguments: &[&str]) -> Output {
    command(home, arguments).output().unwrap()
}

fn read(home: &Path, name: &str) -> Vec<u8> {
    std::fs::read(home.join(name)).unwrap()
}

/// Standard error of a run that must end with `code`.
fn failure(code: i32, home: &Path, arguments: &[&str]) -> String {
    let output = run(home, arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
    text
}

/// The certificate but for the time it took and where files went.
fn certificate(output: &Output) -> String {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    let kept = text.lines().filter(|line| !line.starts_with("wall-clock"));
    kept.collect::<Vec<_>>().join("\n")
}

#[test]
fn a_run_back_in_time_goes_on_too() {
    for steps in [
        ["--step", "1/32"],
        ["--step", "-1/32"],
        ["--tolerance", "1e-9"],
    ] {
        let name = format!("back-{}", steps.join("-").replace('/', "-"));
        let (whole, parts) = (directory(&name), directory(&format!("{name}-parts")));
        let until = |time| [&["kepler", "--e", "0.3", "--until", time], &steps[..]].concat();
        let first = run(&parts, &until("-1"));
        assert_eq!(first.status.code(), Some(0));
        let wrong = failure(2, &parts, &until("-0.5"));
        assert!(wrong.contains("not earlier than the checkpoint"), "{wrong}");
        let wrong = failure(2, &parts, &until("1"));
        assert!(wrong.contains("--until"), "{wrong}");
        let [made, gone_on] = [&whole, &parts].map(|home| certificate(&run(home, &until("-2"))));
        assert!(made.contains("0.000000 to -2.000000"), "{made}");
        if steps[0] == "--step" {
            // Variable steps that meet -1 are other ones.
            assert_eq!(made, gone_on);
            assert_eq!(read(&whole, "t.csv"), read(&parts, "t.csv"));
        }
    }
}

#[test]
fn a_finished_run_repeated_changes_nothing() {
    for scene in equip_scenes::all() {
        let home = directory(&format!("repeated-{}", scene.name));
        // The number of steps is no multiple of 7, and the last one is shorter than the others.
        let instance = scene.instance(&[]).unwrap();
        let until = format!("{}", 40.37 * instance.suggested_step());
        let every: &[&str] = &["--until", &until, "--every", "7"];
        let first = certificate(&run(&home, &[&[scene.name], every].concat()));
        let (table, picture) = (read(&home, "t.csv"), read(&home, "p.svg"));
        for _ in 0..2 {
            let again = certificate(&run(&home, &[&[scene.name], every].concat()));
            assert_eq!(again, first, "{}", scene.name);
            assert!(read(&home, "t.csv") == table, "{}: table", scene.name);
            assert!(read(&home, "p.svg") == picture, "{}: picture", scene.name);
        }
    }
}

/// The last point of a grid of steps lies an ulp before or behind the end of the run, or on it.
#[test]
fn a_finished_run_whose_grid_misses_the_end_by_rounding_is_repeated() {
    for steps in ["50", "75", "97", "100", "160"] {
        let home = directory(&format!("rounding-{steps}"));
        let arguments = [
            "kepler",
            "--periods",
            "1",
            "--steps-per-period",
            steps,
            "--every",
            "7",
        ];
        let first = certificate(&run(&home, &arguments));
        let (table, picture) = (read(&home, "t.csv"), read(&home, "p.svg"));
        assert_eq!(certificate(&run(&home, &arguments)), first, "{steps}");
        assert!(read(&home, "t.csv") == table, "{steps}: table");
        assert!(read(&home, "p.svg") == picture, "{steps}: picture");
    }
}

/// Killed after its last checkpoint: the rows behind it are there, in part or not at all.
#[test]
fn a_run_killed_at_its_very_end_is_finished() {
    for arguments in [
        &["kepler", "--until", "3.3", "--every", "7"][..],
        &["kepler", "--step", "1/8", "--until", "4"],
        &["pendulum", "--until", "-2.03", "--lyapunov"],
        &["henon-heiles", "--tolerance", "1e-8", "--until", "9.1"],
    ] {
        let home = directory("killed-at-the-end");
        certificate(&run(&home, arguments));
        let (table, picture) = (read(&home, "t.csv"), read(&home, "p.svg"));
        let checkpoint = String::from_utf8(read(&home, "c")).unwrap();
        let written = checkpoint.split("\"bytes\":").nth(1).unwrap();
        let written: usize = written.split([',', '}']).next().unwrap().parse().unwrap();
        let behind = table.len() - written;
        for length in [written, written + behind / 2, table.len()] {
            std::fs::write(home.join("t.csv"), &table[..length]).unwrap();
            let _ = std::fs::remove_file(home.join("p.svg"));
            certificate(&run(&home, arguments));
            assert!(read(&home, "t.csv") == table, "{arguments:?}: {length}");
            assert!(read(&home, "p.svg") == picture, "{arguments:?}: {length}");
        }
    }
}

/// Starts a long run, waits until it has a checkpoint, sends the signal, and returns the exit code.
fn stopped_by(signal: &str, home: &Path, arguments: &[&str]) -> Option<i32> {
    let mut child = command(home, arguments)
        .args(["--checkpoint-every", "0.02", "--quiet"])
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !home.join("c").exists() && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    Command::new("kill").args([signal, &id]).status().unwrap();
    child.wait().unwrap().code()
}

const LONG: [&str; 9] = [
    "kepler", "--step", "1/50", "--until", "2500", "--every", "70", "--stages", "4",
];

#[test]
fn signals_end_a_run_with_everything_written() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let home = directory(&format!("signal{signal}"));
        assert_eq!(stopped_by(signal, &home, &LONG), Some(code), "{signal}");
        let text = String::from_utf8(read(&home, "t.csv")).unwrap();
        let columns = |line: &str| line.split(',').count();
        assert!(text.ends_with('\n') && text.lines().all(|line| columns(line) == 7));
        // The last row is that of the checkpoint, whatever its number is.
        let checkpoint = String::from_utf8(read(&home, "c")).unwrap();
        let index = checkpoint.split("\"index\":").last().unwrap();
        let index: u64 = index.split(',').next().unwrap().parse().unwrap();
        let last: f64 = text
            .lines()
            .last()
            .unwrap()
            .split(',')
            .next()
            .unwrap()
            .parse()
            .unwrap();
        assert!((last - index as f64 / 50.0).abs() < 1e-9, "{last} {index}");
    }
}

#[test]
fn a_picture_of_a_stopped_run_is_whole() {
    let (stopped, whole) = (directory("picture-stopped"), directory("picture-whole"));
    let arguments = [&LONG[..], &["--no-compare"]].concat();
    assert_eq!(stopped_by("-TERM", &stopped, &arguments), Some(143));
    certificate(&run(&stopped, &arguments));
    certificate(&run(&whole, &arguments));
    assert!(read(&stopped, "t.csv") == read(&whole, "t.csv"));
    assert!(read(&stopped, "p.svg") == read(&whole, "p.svg"));
}

#[test]
fn a_table_that_is_not_the_one_written_is_refused() {
    let home = directory("tables");
    let until = |t: &'static str| ["henon-heiles", "--step", "1/20", "--until", t];
    run(&home, &until("100"));
    let (table, checkpoint) = (read(&home, "t.csv"), read(&home, "c"));
    let put = |bytes: &[u8]| std::fs::write(home.join("t.csv"), bytes).unwrap();
    let refused = |arguments: &[&str], what: &str| {
        let text = failure(2, &home, arguments);
        assert!(text.contains("t.csv") && text.contains(what), "{text}");
        assert!(read(&home, "c") == checkpoint);
    };

    std::fs::remove_file(home.join("t.csv")).unwrap();
    refused(&until("200"), "it does not exist");
    put(&table[..table.len() / 2]);
    refused(&until("200"), "the run had written it up to t = 1e2");
    assert!(read(&home, "t.csv") == table[..table.len() / 2]);
    put(b"");
    refused(&until("200"), "the run had written it up to t = 1e2");
    // Of the same length, one digit changed in the row of the checkpoint.
    let mut other = table.clone();
    let place = other.len() - 40;
    other[place] = if other[place] == b'1' { b'2' } else { b'1' };
    put(&other);
    refused(&until("200"), "another run");
    put(&table);
    refused(
        &[&until("200")[..], &["--every", "2"]].concat(),
        "--every 1, not 2",
    );
    refused(&[&until("200")[..], &["--lyapunov"]].concat(), "columns");
    certificate(&run(&home, &until("200")));
    assert!(read(&home, "t.csv").starts_with(&table));

    // A run that wrote no table has none to go on with.
    let bare = directory("tables-bare");
    let mut first = Command::new(env!("CARGO_BIN_EXE_equip"));
    first
        .current_dir(&bare)
        .args(["run", "kepler", "--until", "5", "--checkpoint", "c"]);
    assert!(first.output().unwrap().status.success());
    let text = failure(2, &bare, &["kepler", "--until", "9"]);
    assert!(text.contains("wrote no table"), "{text}");
    assert!(!bare.join("t.csv").exists());
}

#[test]
fn a_long_table_is_gone_on_with_in_little_memory() {
    let home = directory("long-table");
    certificate(&run(&home, &["kepler", "--until", "10"]));
    // 64 MB of rows between the header and the rows of the run.
    let table = String::from_utf8(read(&home, "t.csv")).unwrap();
    let (header, rows) = table.split_once('\n').unwrap();
    let filler = format!("{}\n", rows.lines().next().unwrap()).repeat(1 << 20);
    std::fs::write(home.join("t.csv"), format!("{header}\n{filler}{rows}")).unwrap();
    let long = std::fs::metadata(home.join("t.csv")).unwrap().len();
    // The checkpoint is made to speak of that table, as one of so long a run would.
    let text = String::from_utf8(read(&home, "c")).unwrap();
    let json = text.split_once('\n').unwrap().1;
    let written: u64 = json
        .split("\"bytes\":")
        .nth(1)
        .and_then(|rest| rest.split([',', '}']).next()?.parse().ok())
        .unwrap();
    let bytes = |count: u64| format!("\"bytes\":{count}");
    let json = json.replace(&bytes(written), &bytes(written + filler.len() as u64));
    let fnv = |bytes: &[u8]| {
        let begun = 0xcbf2_9ce4_8422_2325_u64;
        bytes.iter().fold(begun, |sum, &byte| {
            (sum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        })
    };
    // The row at the end of the interval stands behind those of the checkpoint.
    let sum = |table: &[u8], bytes: usize| fnv(&table[..bytes]).to_string();
    let rows_end = usize::try_from(written).unwrap();
    let old = sum(table.as_bytes(), rows_end);
    let new = sum(&read(&home, "t.csv"), rows_end + filler.len());
    assert!(json.contains(&old));
    let json = json.replace(&old, &new);
    let checksum = fnv(json.as_bytes());
    std::fs::write(
        home.join("c"),
        format!("equip checkpoint 2 {checksum:016x}\n{json}"),
    )
    .unwrap();
    // No more address space than the program needs without a table, and less than the table.
    let limited = |arguments: &str| {
        let program = env!("CARGO_BIN_EXE_equip");
        let line = format!("ulimit -v 60000; exec {program} run kepler {arguments}");
        Command::new("sh")
            .current_dir(&home)
            .args(["-c", &line])
            .output()
            .unwrap()
    };
    let without = limited("--until 10");
    assert!(without.status.success(), "{without:?}");
    let with = limited("--until 20 --out t.csv --checkpoint c");
    assert!(with.status.success(), "{with:?}");
    assert!(std::fs::metadata(home.join("t.csv")).unwrap().len() > long);
}

#[test]
fn a_checkpoint_of_another_run_is_refused_in_words() {
    let home = directory("other");
    certificate(&run(&home, &["kepler", "--e", "0.8", "--until", "5"]));
    let text = failure(2, &home, &["kepler", "--e", "0.9", "--until", "9"]);
    assert!(text.contains("its e is 0.8, now it is 0.9"), "{text}");
    let text = failure(2, &home, &["pendulum", "--until", "9"]);
    assert!(
        text.contains("its scene is kepler, now it is pendulum"),
        "{text}"
    );
    let text = failure(2, &home, &["kepler", "--e", "0.8", "--until", "1"]);
    assert!(text.contains("--until"), "{text}");
    for (more, words) in [
        (&["--precision", "dd"][..], "point type f64, this run has"),
        (&["--stages", "6"], "stages 8, this run has 6"),
        (&["--method", "gauss"], "method EQUIP, this run has Gauss"),
        (&["--step", "1/8"], "steps by a tolerance"),
        (
            &["--tolerance", "1e-9"],
            "tolerance 1e-12, this run has 1e-9",
        ),
        (
            &["--alpha-policy", "refuse"],
            "with --alpha-policy within-error, this run has refuse",
        ),
        (&["--until", "-9"], "--until"),
    ] {
        let text = failure(2, &home, &[&["kepler", "--e", "0.8"][..], more].concat());
        assert!(
            text.contains(words) && !text.contains(['{', '`']),
            "{more:?}: {text}"
        );
    }
    certificate(&run(&home, &["kepler", "--e", "4/5", "--until", "9"]));
    // Without a table the columns of the Lyapunov exponent are not in the way.
    let bare = |more: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
        let program = program
            .current_dir(&home)
            .args(["run", "kepler", "--checkpoint", "d"]);
        String::from_utf8(program.args(more).output().unwrap().stderr).unwrap()
    };
    bare(&["--until", "2"]);
    let text = bare(&["--until", "3", "--lyapunov"]);
    assert!(text.contains("without --lyapunov"), "{text}");
}

/// A run that goes on without its table says so.
#[test]
fn a_table_that_is_left_behind_is_named() {
    let home = directory("left-behind");
    certificate(&run(&home, &["kepler", "--until", "5"]));
    let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
    let program =
        program
            .current_dir(&home)
            .args(["run", "kepler", "--until", "6", "--checkpoint", "c"]);
    let output = program.output().unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("there is no --out"), "{text}");
}

#[test]
fn every_changed_bit_of_a_checkpoint_is_refused() {
    let home = directory("bits");
    certificate(&run(&home, &["kepler", "--until", "5"]));
    let whole = read(&home, "c");
    // Far apart, so that it takes no time, and over all of the file; the first line bit by bit.
    let mut places: Vec<usize> = (0..40).collect();
    places.extend((40..whole.len()).step_by(whole.len() / 60));
    for (k, place) in places.into_iter().enumerate() {
        let mut bytes = whole.clone();
        bytes[place] ^= 1 << (k % 8);
        std::fs::write(home.join("c"), &bytes).unwrap();
        let text = failure(2, &home, &["kepler", "--until", "9"]);
        assert!(text.contains("is not a checkpoint"), "{text}");
        assert!(!text.contains("remove"), "{text}");
    }
    for short in [0, 1, 30, whole.len() / 2, whole.len() - 1] {
        std::fs::write(home.join("c"), &whole[..short]).unwrap();
        failure(2, &home, &["kepler", "--until", "9"]);
    }
}

#[test]
fn only_an_ordinary_file_is_a_checkpoint() {
    let home = directory("devices");
    for path in ["/dev/full", "/dev/stdout", "."] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_equip"));
        program
            .current_dir(&home)
            .args(["run", "kepler", "--checkpoint", path]);
        let output = program.stdin(Stdio::null()).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{path}: {text}");
        assert!(text.contains("an ordinary file"), "{path}: {text}");
    }
}
