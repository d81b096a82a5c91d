//! Ensembles: the bytes of the file do not depend on threads, shards and interruptions, and what does not
//! belong together is refused.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests
#![cfg(unix)]

use equip_integrate::Equip;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A directory of one test alone, empty.
fn directory(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("ensemble-{name}"));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir_all(&path).unwrap();
    path
}

fn command(home: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_equip"));
    command.current_dir(home).args(line.split(' '));
    command
}

/// Standard output of a command that must succeed.
fn equip(home: &Path, line: &str) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command(home, line).output().unwrap();
    let error = String::from_utf8(stderr).unwrap();
    assert!(status.success(), "{line}: {error}");
    String::from_utf8(stdout).unwrap()
}

/// Standard error of a command that must be refused as bad usage.
fn refused(home: &Path, line: &str) -> String {
    let output = command(home, line).output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{line}: {error}");
    error
}

fn read(home: &Path, name: &str) -> String {
    std::fs::read_to_string(home.join(name)).unwrap()
}

/// The cells of the rows.
fn cells(text: &str) -> Vec<Vec<&str>> {
    let rows = text.lines().skip(2);
    rows.map(|row| row.split(',').collect()).collect()
}

const SOME: &str = "ensemble henon-heiles --n 37 --seed 7 --until 50 --tolerance 1e-11 --stages 8";

#[test]
fn shards_and_threads_make_the_bytes_of_one_program() {
    let home = directory("shards");
    let text = equip(&home, &format!("{SOME} --out whole"));
    assert!(text.contains("37") && text.contains("members written to"));
    for count in [1, 3, 8] {
        let mut parts = Vec::new();
        for k in (1..=count).rev() {
            let threads = 1 + k % 3;
            let part = format!("{count}-{k}");
            equip(
                &home,
                &format!("{SOME} --shard {k}/{count} --threads {threads} --out {part}"),
            );
            parts.push(part);
        }
        equip(&home, &format!("merge {} --out merged", parts.join(" ")));
        assert!(read(&home, "merged") == read(&home, "whole"), "{count}");
    }
    // The merged file is that of an ensemble, and is whole.
    let text = equip(&home, &format!("{SOME} --out merged"));
    assert!(text.contains("37 of them there before"), "{text}");
    assert!(read(&home, "merged") == read(&home, "whole"));
}

#[test]
fn a_member_is_a_run_of_its_own_from_a_start_near_that_of_the_scene() {
    let home = directory("members");
    equip(
        &home,
        "ensemble kepler --e 0.3 --n 50 --seed 3 --spread 0.02 --step 1/16 --until 20 --out a",
    );
    let text = read(&home, "a");
    let instance = equip_scenes::find("kepler").unwrap();
    let instance = instance.instance(&[("e", "0.3")]).unwrap();
    let (q0, p0) = instance.initial::<f64>();
    let mut moved = Vec::new();
    for (i, row) in cells(&text).iter().enumerate() {
        assert_eq!(row[0], i.to_string());
        let x: Vec<f64> = row[1..11]
            .iter()
            .map(|cell| cell.parse().unwrap())
            .collect();
        for (x, x0) in x[..4].iter().zip(q0.iter().chain(&p0)) {
            assert!((x - x0).abs() <= 0.02 * x0.abs());
            if *x0 != 0.0 {
                moved.push((x / x0 - 1.0) / 0.02);
            }
        }
        let run = Equip::stages(8).step(1.0 / 16.0);
        let run = run.integrate(instance.hamiltonian(), &x[..2], &x[2..4], 0.0..=20.0);
        let run = run.unwrap();
        let (t, q, p) = run.last();
        assert_eq!((t, q, p), (x[4], &x[5..7], &x[7..9]));
        assert_eq!(run.certificate().energy.as_ref().unwrap().max, x[9]);
        assert_eq!(
            &row[11..14],
            [&run.certificate().counts.steps.to_string(), "true", "\"\""]
        );
    }
    // Uniform in [-1, 1): mean 0 ± 0.058, mean square 1/3 ± 0.03 of 100 draws; three of these.
    let mean = |f: fn(&f64) -> f64| moved.iter().map(f).sum::<f64>() / moved.len() as f64;
    assert_eq!(moved.len(), 100);
    assert!(mean(|u| *u).abs() < 0.18 && (mean(|u| u * u) - 1.0 / 3.0).abs() < 0.09);
}

/// One bit is changed in each of many places: the file is refused, by `ensemble` and by `merge`, or, where
/// the last row has lost its end, made whole again.
#[test]
fn changed_bytes_of_an_ensemble_are_refused() {
    let home = directory("changed");
    let line = "ensemble kepler --n 6 --seed 1 --until 2 --out a";
    equip(&home, line);
    let whole = read(&home, "a").into_bytes();
    let mut refused_of = 0;
    for (k, place) in (0..whole.len())
        .step_by(11)
        .chain([whole.len() - 1])
        .enumerate()
    {
        let mut bytes = whole.clone();
        bytes[place] ^= 1 << (k % 8);
        std::fs::write(home.join("a"), &bytes).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_equip"))
            .current_dir(&home)
            .args(line.split(' '))
            .output()
            .unwrap();
        if output.status.success() {
            assert_eq!(place, whole.len() - 1);
            assert!(read(&home, "a").into_bytes() == whole, "{place}");
        } else {
            assert_eq!(output.status.code(), Some(2));
            assert!(std::fs::read(home.join("a")).unwrap() == bytes, "{place}");
            refused(&home, "merge a --out b");
            refused_of += 1;
        }
    }
    assert!(refused_of > 100, "{refused_of}");
}

#[test]
fn a_member_that_fails_is_a_row() {
    let home = directory("failing");
    // Beyond the saddle orbits of Hénon and Heiles reach infinity in finite time.
    let line =
        "ensemble henon-heiles --energy 1/7 --n 40 --spread 1 --until 100 --step 1/16 --out a";
    let text = equip(&home, line);
    let text_of = read(&home, "a");
    let rows = cells(&text_of);
    let failed: Vec<_> = rows.iter().filter(|row| row[5] == "NaN").collect();
    assert!(!failed.is_empty() && failed.len() < 40, "{}", failed.len());
    assert!(
        failed
            .iter()
            .all(|row| row[11] == "0" && row[12] == "false" && row[13].len() > 20)
    );
    let said = text
        .lines()
        .find(|line| line.starts_with("failed"))
        .unwrap();
    assert!(said.ends_with(&format!(" {}", failed.len())), "{said}");
    assert_eq!(rows.len(), 40);
}

const LONG: &str = "ensemble henon-heiles --n 100 --until 500 --step 1/10 --threads 2 --out a";

/// Starts a long ensemble, waits until some members are in its file, and ends it by the signal.
fn stopped_by(signal: &str, home: &Path) -> (Option<i32>, String) {
    let child = command(home, LONG).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    let rows = || std::fs::read_to_string(home.join("a")).map_or(0, |text| text.lines().count());
    while rows() < 5 && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let id = child.id().to_string();
    Command::new("kill").args([signal, &id]).status().unwrap();
    let ended = child.wait_with_output().unwrap();
    (
        ended.status.code(),
        String::from_utf8(ended.stderr).unwrap(),
    )
}

#[test]
fn what_was_finished_outlives_the_program() {
    let whole = directory("whole");
    equip(&whole, LONG);
    for (signal, code) in [("-KILL", None), ("-TERM", Some(143)), ("-INT", Some(130))] {
        let home = directory(&format!("stopped{signal}"));
        let (found, error) = stopped_by(signal, &home);
        assert_eq!(found, code, "{error}");
        if code.is_some() {
            assert!(
                error.contains("the same command makes the others"),
                "{error}"
            );
        }
        let part = read(&home, "a");
        let kept = part.matches('\n').count() - 2;
        assert!((3..100).contains(&kept), "{kept}");
        let unfinished = refused(&home, "merge a --out b");
        assert!(
            unfinished.contains("of its 100 members still to be made"),
            "{unfinished}"
        );
        // A row that was being written when the power failed.
        std::fs::write(home.join("a"), format!("{part}99,0.1")).unwrap();
        let text = equip(&home, LONG);
        assert!(
            text.contains(&format!("{kept} of them there before")),
            "{text}"
        );
        assert!(read(&home, "a") == read(&whole, "a"), "{signal}");
    }
}

#[test]
fn files_of_other_ensembles_are_refused() {
    let home = directory("other");
    equip(&home, &format!("{SOME} --shard 1/3 --out a"));
    let before = read(&home, "a");
    for (now, words) in [
        ("--seed 8 --n 37", "its seed is 7, now it is 8"),
        ("--seed 7 --n 38", "its n is 37, now it is 38"),
        (
            "--seed 7 --n 37 --spread 0.5",
            "its spread is 0.01, now it is 0.5",
        ),
        (
            "--seed 7 --n 37 --energy 1/10",
            "its energy is 1/12, now it is 1/10",
        ),
    ] {
        let line = SOME.replace("--n 37 --seed 7", now);
        let error = refused(&home, &format!("{line} --shard 1/3 --out a"));
        assert!(error.contains(words), "{error}");
    }
    let error = refused(&home, &format!("{SOME} --shard 2/3 --out a"));
    assert!(error.contains("its shard is 1/3, now it is 2/3"), "{error}");
    assert_eq!(read(&home, "a"), before);

    std::fs::write(home.join("text"), "something else\n").unwrap();
    let error = refused(&home, &format!("{SOME} --out text"));
    assert!(error.contains("not the file of an ensemble"), "{error}");
    assert_eq!(read(&home, "text"), "something else\n");
}

#[test]
fn options_are_checked_before_anything_is_made() {
    let home = directory("options");
    for (options, words) in [
        ("--n 0", "a whole number from 1"),
        ("--n 9 --shard 5/4", "there are shards 1/4 to 4/4"),
        ("--n 9 --shard 0/4", "there are shards 1/4 to 4/4"),
        ("--n 9 --shard 2", "K/COUNT"),
        (
            "--n 9 --spread -1",
            "--spread is -1; it must be from 0 to 1",
        ),
        ("--n 9 --threads 0", "a whole number"),
        ("--n 9 --step -0.1 --until 1", "without its sign"),
        ("--n 9 --tolerance 2", "--tolerance is 2"),
        ("--n 9 --until inf", "--until"),
        ("--n 9 --e 2", "out of range"),
        ("--n 9 --seed x", "--seed"),
    ] {
        let error = refused(&home, &format!("ensemble kepler {options} --out a"));
        assert!(error.contains(words), "{options}: {error}");
    }
    refused(&home, "ensemble kepler --out a");
    refused(&home, "ensemble kepler --n 9");
    refused(&home, "ensemble nothing --n 9 --out a");
    assert!(!home.join("a").exists());
    let output = command(&home, "ensemble kepler --n 1 --until 1 --out none/a").output();
    assert_eq!(output.unwrap().status.code(), Some(1));
}

#[test]
fn what_is_merged_is_one_ensemble_and_whole() {
    let home = directory("merge");
    for k in [1, 2, 3] {
        equip(&home, &format!("{SOME} --shard {k}/3 --out {k}"));
    }
    equip(&home, &format!("{SOME} --shard 1/2 --out half"));
    let line = SOME.replace("--seed 7", "--seed 8");
    equip(&home, &format!("{line} --shard 2/3 --out seed"));
    for (files, words) in [
        ("1 3", "of the ensemble 2/3 is missing"),
        ("3", "of the ensemble 1/3, 2/3 is missing"),
        ("1 2 3 ./2", "2 and ./2 are both shard 2; give each once"),
        ("1 seed 3", "seed is 7 in the one and 8 in the other"),
        (
            "1 2 half",
            "number of shards is 3 in the one and 2 in the other",
        ),
        ("1 2 none", "cannot read none"),
    ] {
        let error = refused(&home, &format!("merge {files} --out all"));
        assert!(error.contains(words), "{files}: {error}");
    }
    let error = refused(&home, "merge 1 2 3 --out 1");
    assert!(error.contains("name two files"), "{error}");
    refused(&home, "merge --out all");
    assert!(!home.join("all").exists());
    // Files that are not this ensemble are left as they are, also where the file stands while it is written.
    let seed = read(&home, "seed");
    for (file, content, words) in [
        ("all", "my notes\n", "is not the file of an ensemble"),
        ("all.new", "my notes\n", "is not the file of an ensemble"),
        ("all", &seed, "its seed is 8, now it is 7"),
        (
            "all",
            &read(&home, "half"),
            "its shard is 1/2, now it is 1/1",
        ),
    ] {
        std::fs::write(home.join(file), content).unwrap();
        let error = refused(&home, "merge 3 1 2 --out all");
        assert!(error.contains(words), "{file}: {error}");
        assert!(read(&home, file) == content, "{file} is another");
        std::fs::remove_file(home.join(file)).unwrap();
    }
    std::fs::write(home.join("all"), "").unwrap();
    equip(&home, "merge 3 1 2 --out all --quiet");
    let whole = read(&home, "all");
    // What is there of the ensemble is replaced by all of it.
    let lines = whole.split_inclusive('\n').take(4);
    std::fs::write(home.join("all"), lines.collect::<Vec<_>>().concat()).unwrap();
    equip(&home, "merge 3 1 2 --out all --quiet");
    assert!(read(&home, "all") == whole);
}
