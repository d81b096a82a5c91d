//! Pictures: what is drawn, and that it is well-formed SVG.

use crate::{failure, file, stdout, table, well_formed};

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
    assert!(drawn(&[]).contains("Gauss, same tolerance"));
    assert!(drawn(&["--step", "0.1"]).contains("Gauss, same steps"));
    assert!(!drawn(&["--no-compare"]).contains("Gauss"));
    assert!(!drawn(&["--method", "gauss"]).contains("same tolerance"));
}

/// With 8 steps a revolution a line from step to step would be an octagon, which leaves the orbit by 1 −
/// cos(π/8) = 7.6 %.
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
        .filter(|path| path.contains('L') && !path.contains('z'))
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

/// The path of 2100 steps is drawn by its curve, and that of a run too long for it by dots: steps are never
/// joined by lines.
#[test]
fn lines_are_curves() {
    let plot = file("many.svg");
    let drawn = |until: &str| {
        let path = plot.to_str().unwrap();
        let arguments = [
            "run",
            "kepler",
            "--step",
            "0.3",
            "--stages",
            "8",
            "--no-compare",
        ];
        stdout(&[&arguments[..], &["--until", until, "--plot", path]].concat());
        let picture = std::fs::read_to_string(&plot).unwrap();
        well_formed(&picture);
        // Lines of the path, which is drawn before the energy.
        let first = picture.split("<path d=\"").nth(1).unwrap();
        first.split('"').next().unwrap().matches('L').count()
    };
    assert!(drawn("630") > 2100);
    assert_eq!(drawn("4200"), 0);
}

/// Figures of a page are its panels one by one, in colours for light and dark paper.
#[test]
fn a_plot_can_be_a_page() {
    let plot = file("page.html");
    let path = plot.to_str().unwrap();
    stdout(&[
        "run",
        "henon-heiles",
        "--until",
        "20",
        "--lyapunov",
        "--plot",
        path,
    ]);
    let page = std::fs::read_to_string(&plot).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    let panels = page.split("class=\"panels\"").nth(1).unwrap();
    assert_eq!(panels.matches("<svg").count(), 4);
    for words in [
        "prefers-color-scheme: dark",
        "|\u{394}H/H\u{2080}|",
        "E = 1/12",
        "round-off level of H",
    ] {
        assert!(page.contains(words), "{words}");
    }
}

/// The energy after a step is often exactly H₀: such points are left out, and the curve stays in the panel
/// above its lower edge.
#[test]
fn exact_zeros_are_no_spikes() {
    let plot = file("zeros.svg");
    let path = plot.to_str().unwrap();
    stdout(&["run", "fput-beta", "--until", "100", "--plot", path]);
    let picture = std::fs::read_to_string(&plot).unwrap();
    let energy = picture.split("|\u{394}H/H\u{2080}|").nth(1).unwrap();
    let lowest = (energy.split("<path d=\"M").skip(1))
        .flat_map(|path| path.split('"').next().unwrap().split('L'))
        .filter_map(|point| point.split_once(' ')?.1.parse::<f64>().ok())
        .fold(0.0, f64::max);
    // The frame ends at 298.
    assert!(lowest > 34.0 && lowest < 290.0, "{lowest}");
}

#[test]
fn pictures_of_runs_of_no_length_are_well_formed() {
    let plot = file("nothing.svg");
    for scene in ["kepler", "pendulum", "fpu", "outer-solar-system"] {
        let path = plot.to_str().unwrap();
        stdout(&["run", scene, "--until", "0", "--lyapunov", "--plot", path]);
        well_formed(&std::fs::read_to_string(&plot).unwrap());
    }
}

#[test]
fn sizes_of_steps_have_the_unit_of_the_scene() {
    let plot = file("units.svg");
    let path = plot.to_str().unwrap();
    stdout(&[
        "run",
        "outer-solar-system",
        "--until",
        "4000",
        "--step",
        "200",
        "--plot",
        path,
    ]);
    let picture = std::fs::read_to_string(&plot).unwrap();
    for words in ["20 steps of 200 days", "x / AU", "time t / days"] {
        assert!(picture.contains(words), "{words}");
    }
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
    let picture = std::fs::read_to_string(&plot).unwrap();
    well_formed(&picture);
    assert!(picture.contains("boundary of the energy surface") && picture.contains("p\u{2082}"));
    failure(2, &["section", "kepler"]);
}
