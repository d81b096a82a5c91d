//! The program as its user meets it: what it prints, what it writes, and how it ends.
#![allow(clippy::unwrap_used)] // the lint does not see that helpers of tests are tests

use equip_scalar::{DoubleDouble, Float};
use std::path::PathBuf;
use std::process::{Command, Output};

fn equip(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_equip"))
        .args(arguments)
        .output()
        .unwrap()
}

/// Standard output of a command that must succeed.
fn stdout(arguments: &[&str]) -> String {
    let output = equip(arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {error}");
    assert!(error.is_empty(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a command that must end with `code`.
fn failure(code: i32, arguments: &[&str]) -> String {
    let output = equip(arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// A file of this test alone.
fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// The cells of a table, row by row, its header first.
fn table(path: &PathBuf) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap();
    let cells = |row: &str| row.split(',').map(str::to_owned).collect();
    text.lines().map(cells).collect()
}

#[test]
fn help_teaches() {
    for arguments in [
        &["--help"][..],
        &["run", "--help"],
        &["scenes", "--help"],
        &["report", "--help"],
        &["growth", "--help"],
    ] {
        assert!(stdout(arguments).contains("Examples:"), "{arguments:?}");
    }
    let help = stdout(&["run", "kepler", "--help"]);
    assert!(help.contains("--e <VALUE>") && help.contains("eccentricity"));
    assert!(!help.contains("--omega"));
    assert!(stdout(&["--version"]).starts_with("equip "));
}

#[test]
fn scenes_are_listed_and_described() {
    let list = stdout(&["scenes"]);
    for scene in equip_scenes::all() {
        assert!(
            list.lines().any(|line| line.starts_with(scene.name)),
            "{}",
            scene.name
        );
        // Long lines are wrapped.
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let page = words(&stdout(&["scenes", scene.name]));
        assert!(page.contains(&words(scene.formula)) && page.contains(&words(scene.source)));
        assert!(
            scene
                .parameters
                .iter()
                .all(|p| page.contains(&format!("--{} ", p.name)))
        );
    }
}

#[test]
fn every_scene_makes_a_few_steps_and_a_picture() {
    for scene in equip_scenes::all() {
        let step = scene.instance(&[]).unwrap().suggested_step();
        let (until, plot) = (
            format!("{}", 4.0 * step),
            file(&format!("{}.svg", scene.name)),
        );
        let plot = plot.to_str().unwrap();
        let printed = stdout(&["run", scene.name, "--until", &until, "--plot", plot]);
        assert!(printed.contains("energy defect"), "{}", scene.name);
        well_formed(&std::fs::read_to_string(plot).unwrap());
    }
}

#[test]
fn table_of_a_run_reads_back() {
    let out = file("kepler.csv");
    stdout(&[
        "run",
        "kepler",
        "--e",
        "0.3",
        "--stages",
        "6",
        "--steps-per-period",
        "100",
        "--until",
        "20",
        "--out",
        out.to_str().unwrap(),
        "--every",
        "10",
        "--quiet",
    ]);
    let rows = table(&out);
    assert_eq!(rows[0].join(","), "t,q1,q2,p1,p2,energy_defect,outcome");
    // 318.3 steps: the initial state, every tenth step, and the last one.
    assert_eq!(rows.len(), 1 + 1 + 31 + 1);
    let kepler = equip_scenes::find("kepler").unwrap();
    let kepler = kepler.instance(&[("e", "0.3")]).unwrap();
    for row in &rows[1..] {
        let numbers: Vec<f64> = row[..6].iter().map(|cell| cell.parse().unwrap()).collect();
        let (q, p) = kepler.exact(numbers[0]).unwrap();
        let exact = [q, p].concat();
        // Measured 6.6e-15 at the end, after three periods; headroom of 10.
        let error = numbers[1..5].iter().zip(&exact).map(|(a, b)| (a - b).abs());
        assert!(error.fold(0.0, f64::max) < 6.6e-14, "{row:?}");
        // Measured 4.4e-16; headroom of 4.
        assert!(numbers[5].abs() < 1.8e-15, "{row:?}");
    }
    assert_eq!(rows.last().unwrap()[0], "2e1");
}

#[test]
fn quiet_is_quiet_and_json_is_json() {
    assert_eq!(stdout(&["run", "pendulum", "--quiet"]), "");
    let text = stdout(&[
        "run", "pendulum", "--json", "--set", "p=1.5", "--until", "10", "--step", "0.1",
    ]);
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["scene"], "pendulum");
    assert_eq!(json["parameters"]["p"], "1.5");
    assert_eq!(
        (json["steps"].as_u64(), json["order"].as_u64()),
        (Some(100), Some(8))
    );
    let outcomes = json["outcomes"].as_object().unwrap();
    assert_eq!(
        outcomes.values().filter_map(|n| n.as_u64()).sum::<u64>(),
        100
    );
    assert!(json["energy"]["max"].as_f64().unwrap() < 1e-14);
    // Measured 7e-14; headroom of 10.
    assert!(json["end_state_error"]["q"].as_f64().unwrap() < 7e-13);
    assert!(json["error"].is_null());
}

#[test]
fn double_double_has_the_digits_of_double_double() {
    let out = file("pendulum.csv");
    stdout(&[
        "run",
        "pendulum",
        "--p",
        "1.1",
        "--precision",
        "dd",
        "--stages",
        "10",
        "--step",
        "1/10",
        "--until",
        "5",
        "--out",
        out.to_str().unwrap(),
        "--quiet",
    ]);
    let rows = table(&out);
    let last = rows.last().unwrap();
    let pendulum = equip_scenes::find("pendulum").unwrap();
    let pendulum = pendulum.instance(&[("p", "1.1")]).unwrap();
    let (q, p) = pendulum.exact(DoubleDouble::int(5)).unwrap();
    for (cell, exact) in [(&last[1], q[0]), (&last[2], p[0])] {
        let found = DoubleDouble::decimal(cell).unwrap();
        // Measured 1.1e-32, a unit in the last place or so; headroom of 100. Read as a double, 1.1 would leave 1e-16.
        let error: f64 = (found - exact).to_f64();
        assert!(error.abs() < 1.1e-30, "{cell}: {error:e}");
    }
}

#[test]
fn methods_are_what_they_are_called() {
    let printed = |method| stdout(&["run", "kepler", "--until", "5", "--method", method]);
    assert!(printed("equip").contains("EQUIP, 4 stages, order 8"));
    assert!(printed("equip-last").contains("EQUIP with the last α only"));
    assert!(printed("gauss").contains("Gauss, 4 stages, order 8"));
    assert!(printed("fixed-alpha=1/50").contains("fixed α = 0.02, 4 stages, order 6"));
    assert!(printed("fixed-alpha=-0.01").contains("fixed α = -0.01"));
}

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
        (&["run", "kepler", "--step", "0"], "positive"),
        (&["run", "kepler", "--step", "0.1x"], "--step"),
        (
            &["run", "kepler", "--step", "0.1", "--steps-per-period", "9"],
            "cannot be used with",
        ),
        (&["run", "kepler", "--steps-per-period", "-4"], "positive"),
        (&["run", "kepler", "--until", "-1"], "run forward"),
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
    assert!(message.contains("no such directory") && message.contains("make its directory"));
}

#[test]
fn a_run_that_fails_keeps_what_it_made() {
    // One α at hω = 500: the run meets a step without a solution.
    let (out, plot) = (file("refused.csv"), file("refused.svg"));
    let scene =
        "run fpu --omega 500 --method equip-last --stages 2 --step 1 --until 200 --refuse --json";
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
            && message.contains("its steps up to there are written")
    );
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let steps = json["steps"].as_u64().unwrap();
    assert_eq!(table(&out).len() as u64, 1 + 1 + steps);
    assert!(json["error"].as_str().unwrap().contains("no admissible α"));
    well_formed(&std::fs::read_to_string(&plot).unwrap());
}

#[test]
fn the_plot_shows_gauss_beside_it_unless_told_not_to() {
    let plot = file("compare.svg");
    let path = plot.to_str().unwrap();
    let drawn = |more: &[&str]| {
        stdout(
            &[
                &["run", "henon-heiles", "--until", "20", "--plot", path][..],
                more,
            ]
            .concat(),
        );
        std::fs::read_to_string(&plot).unwrap()
    };
    assert!(drawn(&[]).contains("Gauss, same steps"));
    assert!(!drawn(&["--no-compare"]).contains("Gauss"));
    assert!(!drawn(&["--method", "gauss"]).contains("same steps"));
}

/// With 8 steps a revolution a line from step to step would be an octagon, which leaves the orbit by 1 − cos(π/8) = 7.6 %.
#[test]
fn orbits_are_drawn_between_their_steps() {
    let plot = file("curve.svg");
    let arguments =
        "run kepler --e 0 --steps-per-period 8 --stages 8 --periods 1 --no-compare --plot";
    let arguments: Vec<&str> = arguments
        .split(' ')
        .chain([plot.to_str().unwrap()])
        .collect();
    stdout(&arguments);
    let picture = std::fs::read_to_string(&plot).unwrap();
    let path = picture
        .split("<path d=\"")
        .skip(1)
        .map(|p| p.split('"').next().unwrap());
    let points = |path: &str| -> Vec<(f64, f64)> {
        let numbers = path.trim_start_matches('M').split('L').map(|point| {
            let (x, y) = point.split_once(' ').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        });
        numbers.collect()
    };
    let orbit = path
        .filter(|path| path.contains('L'))
        .map(points)
        .max_by_key(Vec::len)
        .unwrap();
    assert!(orbit.len() > 80, "{}", orbit.len());
    let range = |x: fn(&(f64, f64)) -> f64| {
        let (low, high) = orbit
            .iter()
            .map(x)
            .fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        ((low + high) / 2.0, (high - low) / 2.0)
    };
    let ((x, radius), (y, _)) = (range(|p| p.0), range(|p| p.1));
    for point in &orbit {
        let off = (point.0 - x).hypot(point.1 - y) / radius - 1.0;
        assert!(off.abs() < 0.01, "{off}");
    }
}

/// Every element of the SVG is closed in its order, and no number in it is NaN or infinite.
fn well_formed(text: &str) {
    let mut open = Vec::new();
    assert!(text.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
    for element in text.split('<').skip(1) {
        let (tag, content) = element.split_once('>').unwrap();
        assert!(
            !content.contains('>') && tag.matches('"').count() % 2 == 0,
            "{tag}"
        );
        assert!(!tag.contains("NaN") && !tag.contains("inf"), "{tag}");
        let name = tag
            .trim_start_matches('/')
            .split([' ', '/'])
            .next()
            .unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty() && text.ends_with("</svg>\n"));
}

#[test]
fn variable_steps_follow_a_tolerance() {
    let text = stdout(&[
        "run",
        "kepler",
        "--e",
        "0.9",
        "--stages",
        "8",
        "--tolerance",
        "1e-12",
        "--until",
        "10",
    ]);
    assert!(
        text.contains("tolerance") && text.contains("steps refused"),
        "{text}"
    );
    failure(
        2,
        &["run", "kepler", "--tolerance", "1e-12", "--step", "0.1"],
    );
    let json = stdout(&["run", "kepler", "--tolerance", "1e-8", "--json"]);
    assert!(json.contains("\"variable_steps\": {"), "{json}");
    failure(2, &["run", "kepler", "--tolerance", "1"]);
}

#[test]
fn a_deviation_is_followed() {
    let (out, plot) = (file("chaos.csv"), file("chaos.svg"));
    let run = |energy: &str, q2: &str, more: &[&str]| {
        let common = [
            "run",
            "henon-heiles",
            "--stages",
            "6",
            "--tolerance",
            "1e-9",
        ];
        let orbit = [
            "--energy", energy, "--q2", q2, "--p2", "0", "--until", "1000",
        ];
        stdout(&[&common[..], &orbit, more].concat())
    };
    let written = [
        "--lyapunov",
        "--out",
        out.to_str().unwrap(),
        "--plot",
        plot.to_str().unwrap(),
    ];
    let text = run("1/8", "-0.25", &written);
    assert!(
        text.contains("Lyapunov exponent") && text.contains("MEGNO"),
        "{text}"
    );
    let rows = table(&out);
    assert!(rows[0].join(",").ends_with("outcome,lyapunov,megno"));
    assert!(rows.iter().all(|row| row.len() == rows[0].len()));
    // Measured 0.076 and 37.
    let last: Vec<f64> = rows.last().unwrap()[7..]
        .iter()
        .map(|x| x.parse().unwrap())
        .collect();
    assert!(last[0] > 0.03 && last[1] > 15.0, "{last:?}");
    let picture = std::fs::read_to_string(&plot).unwrap();
    well_formed(&picture);
    assert!(picture.contains("MEGNO"));
    // The other name of the option; a regular orbit.
    let json = run("1/8", "0.483", &["--megno", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let megno = json["chaos"]["megno"].as_f64().unwrap();
    assert!((megno - 2.0).abs() < 0.3, "{megno}");
    assert!(!run("1/8", "0.483", &[]).contains("MEGNO"));
}

#[test]
fn growth_is_drawn() {
    let (plot, csv) = (file("growth.svg"), file("growth.csv"));
    let text = stdout(&[
        "growth",
        "--eccentricities",
        "0.6,0.9",
        "--tolerances",
        "1e-12",
        "--revolutions",
        "30",
        "--plot",
        plot.to_str().unwrap(),
        "--csv",
        csv.to_str().unwrap(),
    ]);
    assert_eq!(
        text.lines()
            .filter(|line| line.contains("| EQUIP |"))
            .count(),
        2
    );
    well_formed(&std::fs::read_to_string(&plot).unwrap());
    let rows = table(&csv);
    let last = |method: &str| -> f64 {
        let of_method = |row: &&Vec<String>| row[0] == "0.9" && row[2] == method;
        let row = rows.iter().rfind(of_method).unwrap();
        assert_eq!(row[3], "30.3");
        row[4].parse().unwrap()
    };
    // Measured 1e-11 and 2e-9.
    assert!(last("EQUIP") < 1e-10 && last("Gauss") > 10.0 * last("EQUIP"));
    failure(2, &["growth", "--tolerances", "no"]);
    failure(
        2,
        &["growth", "--eccentricities", "2", "--revolutions", "1"],
    );
}

#[test]
fn a_step_is_found_for_an_error() {
    let json = stdout(&[
        "run",
        "kepler",
        "--e",
        "0.3",
        "--stages",
        "6",
        "--periods",
        "50.3",
        "--target-error",
        "1e-8",
        "--json",
    ]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let error = json["end_state_error"]["q"].as_f64().unwrap();
    // Measured 3.5e-9; errors do not grow quite linearly in the first period.
    assert!(error < 5e-8 && error > 1e-10, "{error}");
    failure(
        2,
        &["run", "kepler", "--target-error", "1e-8", "--step", "0.1"],
    );
    let text = failure(2, &["run", "kepler", "--target-error", "1e-20"]);
    assert!(text.contains("take a larger target"), "{text}");
}

#[test]
fn a_section_is_drawn() {
    let (plot, csv) = (file("section.svg"), file("section.csv"));
    let text = stdout(&[
        "section",
        "henon-heiles",
        "--energy",
        "1/12",
        "--orbits",
        "5",
        "--until",
        "200",
        "--plot",
        plot.to_str().unwrap(),
        "--csv",
        csv.to_str().unwrap(),
    ]);
    assert!(text.contains("of 5 orbits"), "{text}");
    let rows = table(&csv);
    // About one crossing every 2π.
    assert!(rows.len() > 100 && rows.len() < 220, "{}", rows.len());
    for row in &rows[1..] {
        let (q2, p2): (f64, f64) = (row[1].parse().unwrap(), row[2].parse().unwrap());
        // p1² is what is left.
        assert!(1.0 / 6.0 - q2 * q2 + 2.0 / 3.0 * q2.powi(3) - p2 * p2 > 0.0);
    }
    assert!(std::fs::read_to_string(&plot).unwrap().contains("<path"));
    failure(2, &["section", "kepler"]);
}

/// Runs with a checkpoint at every step, kills the program in the middle, goes on, and compares the table with that of a run that was left alone.
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
