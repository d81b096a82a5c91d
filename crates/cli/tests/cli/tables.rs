//! Tables, summaries and JSON of runs.

use crate::{failure, file, stdout, table, well_formed};
use equip_integrate::Equip;
use equip_scalar::{DoubleDouble, Float};

#[test]
fn a_run_back_in_time_ends_where_the_orbit_was() {
    // Kepler's orbit from its pericentre is the same backwards, mirrored.
    let run = |until: &'static str| {
        let out = file(&format!("kepler{until}.csv"));
        let plot = file(&format!("kepler{until}.svg"));
        let paths = [&out, &plot].map(|path| path.to_str().unwrap());
        let [out_path, plot_path] = paths;
        stdout(&[
            "run",
            "kepler",
            "--e",
            "0.3",
            "--until",
            until,
            "--out",
            out_path,
            "--plot",
            plot_path,
            "--lyapunov",
            "--quiet",
        ]);
        well_formed(&std::fs::read_to_string(&plot).unwrap());
        let rows = table(&out);
        let last: Vec<f64> = rows.last().unwrap()[..5]
            .iter()
            .map(|x| x.parse().unwrap())
            .collect();
        (rows.len(), last)
    };
    let ((there_rows, there), (back_rows, back)) = (run("7.5"), run("-7.5"));
    assert_eq!(there_rows, back_rows);
    for (i, sign) in [-1.0, 1.0, -1.0, -1.0, 1.0].into_iter().enumerate() {
        assert!(
            (there[i] - sign * back[i]).abs() < 1e-12,
            "{there:?} {back:?}"
        );
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
    assert_eq!(rows[0].join(","), "t,q1,q2,p1,p2,energy_error,outcome");
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
        (Some(100), Some(16))
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

/// What the library writes with serde and what the program writes have the same names.
#[test]
fn names_of_the_document_are_those_of_the_certificate() {
    let kepler = equip_scenes::find("kepler").unwrap();
    let kepler = kepler.instance(&[]).unwrap();
    let (q, p) = kepler.initial::<f64>();
    let options = Equip::stages(8).tolerance(1e-8).chaos();
    let run = options.integrate(kepler.hamiltonian(), &q, &p, 0.0..=5.0);
    let library = serde_json::to_value(run.unwrap().certificate()).unwrap();
    let text = stdout(&[
        "run",
        "kepler",
        "--tolerance",
        "1e-8",
        "--lyapunov",
        "--until",
        "5",
        "--json",
    ]);
    let program: serde_json::Value = serde_json::from_str(&text).unwrap();
    let mut compared = 0;
    for (name, value) in library.as_object().unwrap() {
        // Of the method the program writes the words.
        let inside = match name.as_str() {
            "method" => continue,
            "counts" => &program["work"],
            "output_steps" | "coarse_outputs" => &program["work"][name],
            _ => &program[name],
        };
        assert!(!inside.is_null() || value.is_null(), "{name}");
        for part in value.as_object().into_iter().flat_map(|map| map.keys()) {
            let found = match part.as_str() {
                "steps" | "outcomes" if name == "counts" => &program[part],
                _ => &inside[part],
            };
            assert!(!found.is_null(), "{name}.{part}: {program}");
            compared += 1;
        }
    }
    assert!(compared > 20, "{compared} names");
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
        // Measured 1.1e-32, a unit in the last place or so; headroom of 100. Read as a double, 1.1 would
        // leave 1e-16.
        let error: f64 = (found - exact).to_f64();
        assert!(error.abs() < 1.1e-30, "{cell}: {error:e}");
    }
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
        text.contains("tolerance") && text.contains("steps rejected"),
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
fn a_tangent_vector_is_followed() {
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
    assert!(text.contains("use a larger target"), "{text}");
}
