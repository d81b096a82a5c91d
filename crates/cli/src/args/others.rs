//! Options of the commands other than `equip run`.

use super::shared::{stages, whole};
use crate::limits::{LEVELS, TRAJECTORY, UNCORRECTED};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  equip scenes\n  equip scenes henon-heiles")]
pub(crate) struct ScenesArgs {
    /// Scene to describe; all are listed if none is named
    pub(crate) name: Option<String>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "The plane q1 = 0, crossed with p1 > 0: closed curves are regular orbits, clouds are chaotic ones. At energy 1/12 nearly all are \
        regular, at 1/8 some, at 1/6 nearly none.\n\n\
        Examples:\n  \
        equip section henon-heiles --energy 1/8 --plot section.svg\n  \
        equip section henon-heiles --energy 1/6 --orbits 8 --until 10000 --csv section.csv"
)]
pub(crate) struct SectionArgs {
    /// Scene; henon-heiles is the only one so far
    pub(crate) scene: String,
    /// Energy of the orbits, up to that of the escape, 1/6
    #[arg(
        long,
        value_name = "E",
        default_value = "1/8",
        allow_hyphen_values = true
    )]
    pub(crate) energy: String,
    /// Number of orbits
    #[arg(long, value_name = "N", default_value_t = 24, allow_negative_numbers = true, value_parser = whole(1, 10_000))]
    pub(crate) orbits: u64,
    /// Time to end at, for each orbit
    #[arg(
        long,
        value_name = "T",
        default_value = "2000",
        allow_hyphen_values = true
    )]
    pub(crate) until: String,
    /// Stages s: the order is 2s
    #[arg(long, short, default_value_t = 8, allow_negative_numbers = true, value_parser = stages, help_heading = "Method")]
    pub(crate) stages: usize,
    /// Tolerance of the variable steps
    #[arg(
        long,
        value_name = "TOL",
        default_value = "1e-11",
        allow_hyphen_values = true,
        help_heading = "Method"
    )]
    pub(crate) tolerance: String,
    /// Where to draw; a page if the name ends in .html
    #[arg(
        long,
        value_name = "FILE.svg",
        default_value = "section.svg",
        help_heading = "Output"
    )]
    pub(crate) plot: PathBuf,
    /// Write orbit, q2 and p2 of every crossing
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub(crate) csv: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Both methods have variable steps under the same control. The error is the largest of a component of position and momentum, against the closed \
        form, 0.3 revolutions after the N-th. The table has N = 1, 10, 100, …, the picture more of them.\n\n\
        Examples:\n  \
        equip growth\n  \
        equip growth --eccentricities 0.6,0.99 --tolerances 1e-10 --revolutions 10000 --csv growth.csv"
)]
pub(crate) struct GrowthArgs {
    /// Eccentricities, one panel each
    #[arg(
        long,
        value_name = "E,E,…",
        value_delimiter = ',',
        allow_hyphen_values = true,
        default_value = "0.6,0.9,0.99,0.999"
    )]
    pub(crate) eccentricities: Vec<String>,
    /// Tolerances of the variable steps
    #[arg(
        long,
        value_name = "TOL,TOL,…",
        value_delimiter = ',',
        allow_hyphen_values = true,
        default_value = "1e-12,1e-14",
        help_heading = "Method"
    )]
    pub(crate) tolerances: Vec<String>,
    /// Revolutions to make
    #[arg(long, value_name = "N", default_value_t = 1000, allow_negative_numbers = true, value_parser = whole(1, 1_000_000))]
    pub(crate) revolutions: u64,
    /// Stages s: the order is 2s
    #[arg(long, short, default_value_t = 8, allow_negative_numbers = true, value_parser = stages, help_heading = "Method")]
    pub(crate) stages: usize,
    /// Where to draw; a page if the name ends in .html
    #[arg(
        long,
        value_name = "FILE.svg",
        default_value = "growth.svg",
        help_heading = "Output"
    )]
    pub(crate) plot: PathBuf,
    /// Write the errors, all that are drawn
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub(crate) csv: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(
    after_help = check_help()
)]
pub(crate) struct CheckArgs {
    /// The rows that are made in at most two minutes
    #[arg(long)]
    pub(crate) quick: bool,
    /// Rows whose theme, name or setting contains TEXT
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Option<String>,
    /// Write all figures as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) json: Option<PathBuf>,
    /// Write the table as comma-separated values
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) csv: Option<PathBuf>,
    /// Write the table as a page for the browser
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) html: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Brugnano, Iavernaro, Trigiante (2010): a Gauss method with one free parameter α, for which every step solves H(y1) = H(y0), however \
        far α moves the end of the step (equip run --method equip-last --reach always). Kepler's problem, e = 0.6: orders, α₀(h) = const · h², the \
        energy error of a step over α, angular momentum, and the energy over 1000 periods, each line with what is stated, what is \
        measured, and whether it holds. Takes less than ten seconds.\n\n\
        Exit codes: 0 every statement holds; 1 one does not, or the output failed; 2 bad usage.\n\n\
        Examples:\n  \
        equip paper\n  \
        equip paper --html paper.html --json paper.json"
)]
pub(crate) struct PaperArgs {
    /// Write all figures as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) json: Option<PathBuf>,
    /// Write statements, tables and pictures as a page for the browser
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) html: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "First Kepler's problem with step control: error and energy after 1000 revolutions, 10\u{2075} in the complete report, and with close \
        encounters (long-runs, close-encounters). Then for each scene error and energy error against run time, work counts, and the time to \
        given errors, of EQUIP and Gauss with several numbers of stages. Three sentences on top say what the figures of the run say. All \
        use the gradient derived from H; benches/peers compares with other methods and programs.\n\n\
        The directory gets report.html, which needs nothing else, runs.csv, times.csv, and for long runs, close encounters and each scene an SVG file.\n\n\
        Examples:\n  \
        equip report --quick\n  \
        equip report --only kepler --out kepler-report\n  \
        equip report --peers benches/peers/out/peers.json"
)]
pub(crate) struct ReportArgs {
    /// Fewer scenes and methods, in less than half a minute; all of it takes less than twelve minutes
    #[arg(long)]
    pub(crate) quick: bool,
    /// Parts whose name, like long-runs, kepler-0.6-f64 or pendulum-dd, contains TEXT
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Option<String>,
    /// Time to spend on the scenes; more of it means finer settings and more repeats
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    pub(crate) seconds: Option<f64>,
    /// Directory to write to; it is made if it is not there
    #[arg(
        long,
        value_name = "DIR",
        default_value = "equip-report",
        help_heading = "Output"
    )]
    pub(crate) out: PathBuf,
    /// Join what benches/peers measured to the page
    #[arg(long, value_name = "peers.json", help_heading = "Output")]
    pub(crate) peers: Option<PathBuf>,
}

/// With the limits by which rows are judged.
fn check_help() -> String {
    format!(
        "Every row is integrated with EQUIP and with Gauss on the same steps. It passes if every step is accounted \
        for, the energy error is within {LEVELS} round-off levels of H wherever the energy is said to be conserved, quadratic invariants \
        are conserved to round-off, steps whose energy error is left have at most {UNCORRECTED} times the energy error of Gauss, and the \
        trajectory error is at most {TRAJECTORY} times that of Gauss (that of the slow variables where fast oscillations are not resolved).\n\n\
        A row that is known to exceed the last of these, with its figure, is a known deficit, and does not fail.\n\n\
        Exit codes: 0 no row failed; 1 a row failed or the output did; 2 bad usage.\n\n\
        Examples:\n  \
        equip check --quick\n  \
        equip check --only fpu\n  \
        equip check --html check.html --json check.json"
    )
}

fn seconds(text: &str) -> Result<f64, &'static str> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1e6 => Ok(x),
        _ => Err("a positive number of seconds, at most 1e6"),
    }
}
