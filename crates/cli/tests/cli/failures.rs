//! How the program fails: what to change is said, and files are left as they are.

use crate::{equip, failure, file, table, well_formed};

#[test]
fn bad_input_says_what_to_change() {
    for (arguments, hint) in [
        (&["run", "keppler"][..], "kepler"),
        (&["scenes", "keppler"], "kepler"),
        (&["run", "kepler", "--e", "1.5"], "[0, 1)"),
        (&["run", "kepler", "--e", "round"], "write a decimal like"),
        (&["run", "kepler", "--set", "e:0.5"], "NAME=VALUE"),
        (&["run", "kepler", "--omega", "3"], "it has e, mu"),
        (&["run", "kepler", "--set", "omega=3"], "it has e, mu"),
        (&["run", "kepler", "--step", "0"], "not zero"),
        (&["run", "kepler", "--step", "0.1x"], "--step"),
        (
            &["run", "kepler", "--step", "0.1", "--steps-per-period", "9"],
            "cannot be used with",
        ),
        (&["run", "kepler", "--steps-per-period", "-4"], "positive"),
        (&["run", "kepler", "--until", "1e999"], "--until"),
        (&["run", "kepler", "--stages", "1"], "2 to 32"),
        (&["run", "kepler", "--stages", "99"], "2 to 32"),
        (&["run", "kepler", "--method", "euler"], "fixed-alpha"),
        (
            &["run", "kepler", "--method", "fixed-alpha=x"],
            "not a decimal number",
        ),
        (&["run", "kepler", "--every", "0"], "--every"),
        (&["run"], "<SCENE>"),
    ] {
        let message = failure(2, arguments);
        assert!(message.contains(hint), "{arguments:?}: {message}");
    }
}

#[test]
fn bad_input_leaves_files_alone() {
    let out = file("untouched.csv");
    std::fs::write(&out, "precious").unwrap();
    failure(
        2,
        &[
            "run",
            "kepler",
            "--step",
            "-1",
            "--out",
            out.to_str().unwrap(),
        ],
    );
    assert_eq!(std::fs::read_to_string(&out).unwrap(), "precious");
}

#[test]
fn a_path_that_cannot_be_written_is_named() {
    let path = file("no such directory").join("a.csv");
    let message = failure(1, &["run", "kepler", "--out", path.to_str().unwrap()]);
    assert!(message.contains("no such directory") && message.contains("create its directory"));
}

#[test]
fn a_run_that_fails_keeps_what_it_made() {
    // One α at hω = 500: the run meets a step without a solution.
    let (out, plot) = (file("refused.csv"), file("refused.svg"));
    let scene = "run fpu --omega 500 --method equip-last --stages 2 --step 1 --until 200 --alpha-policy refuse --json";
    let mut arguments: Vec<_> = scene.split(' ').collect();
    arguments.extend([
        "--out",
        out.to_str().unwrap(),
        "--plot",
        plot.to_str().unwrap(),
    ]);
    let output = equip(&arguments);
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(
        message.contains("no admissible α")
            && message.contains("the steps up to that time are written")
    );
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let steps = json["steps"].as_u64().unwrap();
    assert_eq!(table(&out).len() as u64, 1 + 1 + steps);
    assert!(json["error"].as_str().unwrap().contains("no admissible α"));
    well_formed(&std::fs::read_to_string(&plot).unwrap());
}
