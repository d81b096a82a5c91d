//! Options of the commands other than `equip run`.

use super::shared::{picture, stages, whole};
use crate::limits::{LEVELS, TRAJECTORY, UNCORRECTED};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  equip scenes\n  equip scenes henon-heiles")]
pub(crate) struct ScenesArgs {
    /// Scene to describe; without a name, all scenes are listed
    pub(crate) name: Option<String>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "The section is the plane q1 = 0, crossed with p1 > 0. Closed curves are regular orbits, clouds of points \
        are chaotic orbits. At energy 1/12 nearly all orbits are regular, at 1/8 some, at 1/6 nearly none.\n\n\
        Examples:\n  \
        equip section henon-heiles --energy 1/8 --plot section.svg\n  \
        equip section henon-heiles --energy 1/6 --orbits 8 --until 10000 --csv section.csv"
)]
pub(crate) struct SectionArgs {
    /// Scene; henon-heiles is the only one so far
    pub(crate) scene: String,
    /// Energy of the orbits, at most the escape energy 1/6
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
    /// End time of each orbit
    #[arg(
        long,
        value_name = "T",
        default_value = "2000",
        allow_hyphen_values = true
    )]
    pub(crate) until: String,
    /// Number of stages s; the order is 2s
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
    /// File for the picture; an HTML page if its name ends in .html
    #[arg(
        long,
        value_name = "FILE.svg",
        default_value = "section.svg",
        value_parser = picture,
        help_heading = "Output"
    )]
    pub(crate) plot: PathBuf,
    /// Write orbit number, q2 and p2 of every crossing
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub(crate) csv: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Both methods use the same step size control. The error is the largest over all components of q and p, \
        compared with the closed form, 0.3 revolutions after the N-th. The table has N = 1, 10, 100, …; the picture has \
        further N.\n\n\
        Examples:\n  \
        equip growth\n  \
        equip growth --eccentricities 0.6,0.99 --tolerances 1e-10 --revolutions 10000 --csv growth.csv"
)]
pub(crate) struct GrowthArgs {
    /// Eccentricities, with one panel for each
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
    /// Number of revolutions
    #[arg(long, value_name = "N", default_value_t = 1000, allow_negative_numbers = true, value_parser = whole(1, 1_000_000))]
    pub(crate) revolutions: u64,
    /// Number of stages s; the order is 2s
    #[arg(long, short, default_value_t = 8, allow_negative_numbers = true, value_parser = stages, help_heading = "Method")]
    pub(crate) stages: usize,
    /// File for the picture; an HTML page if its name ends in .html
    #[arg(
        long,
        value_name = "FILE.svg",
        default_value = "growth.svg",
        value_parser = picture,
        help_heading = "Output"
    )]
    pub(crate) plot: PathBuf,
    /// Write all errors that are drawn
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub(crate) csv: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(
    after_help = check_help()
)]
pub(crate) struct CheckArgs {
    /// Omit long cases; takes at most two minutes
    #[arg(long)]
    pub(crate) quick: bool,
    /// Run only rows whose theme, name or setting contains TEXT
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
    after_help = "Brugnano, Iavernaro, Trigiante (2010): a Gauss method with one free parameter α. Every step solves \
        H(y₁) = H(y₀) for α, with no bound on the change of y₁ caused by α (equip run --method equip-last --alpha-policy \
        always). On Kepler's problem with e = 0.6 the command measures the orders, α₀(h) = const · h², the energy error \
        of a step as a function of α, the angular momentum error, and the energy error over 1000 periods. Each line has \
        the statement, the measured figure, and whether the statement holds. Takes less than ten seconds.\n\n\
        Exit codes: 0 every statement holds; 1 a statement does not hold, or the output failed; 2 invalid usage.\n\n\
        Examples:\n  \
        equip paper\n  \
        equip paper --html paper.html --json paper.json"
)]
pub(crate) struct PaperArgs {
    /// Write all figures as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) json: Option<PathBuf>,
    /// Write statements, tables and pictures as an HTML page
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) html: Option<PathBuf>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "The report begins with a conclusion in three sentences, computed from its figures. Then follow \
        long runs with step size control (error and energy error of Kepler's problem with e = 0.6 after 1000 \
        revolutions, in the complete report after 10\u{2075}) and close encounters (e = 0.9, 0.99 and 0.999). Then follows \
        time against error for each scene, with fixed steps, and with step size control for s = 8: error and energy \
        error, counts of work, and the time to given errors. All methods use the gradient derived from H. With --peers \
        other programs follow.\n\n\
        The command writes report.html (self-contained), tables (runs.csv, times.csv, long-runs.csv, \
        close-encounters.csv) and SVG files.\n\n\
        Examples:\n  \
        equip report --quick\n  \
        equip report --only kepler --out kepler-report\n  \
        equip report --peers benches/peers/out/peers.json"
)]
pub(crate) struct ReportArgs {
    /// Use fewer scenes and methods: less than half a minute (complete report: less than twelve minutes)
    #[arg(long)]
    pub(crate) quick: bool,
    /// Run only parts whose name contains TEXT, for example long-runs, kepler-0.6-f64 or pendulum-dd
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Option<String>,
    /// Time to spend on the scenes; more time allows finer settings and more repetitions
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = seconds)]
    pub(crate) seconds: Option<f64>,
    /// Output directory; created if it does not exist
    #[arg(
        long,
        value_name = "DIR",
        default_value = "equip-report",
        help_heading = "Output"
    )]
    pub(crate) out: PathBuf,
    /// Add the results of benches/peers to the page
    #[arg(long, value_name = "peers.json", help_heading = "Output")]
    pub(crate) peers: Option<PathBuf>,
}

/// Help of `equip check`, with the limits for a row.
fn check_help() -> String {
    format!(
        "A row is a case with its setting. Every row is integrated with EQUIP and with Gauss on the same steps. A row \
        passes if every step has an outcome; the energy error is within {LEVELS} round-off levels of H on every step, \
        except uncorrected steps, whose energy error could not be removed; quadratic invariants are conserved to round-off; the energy error of uncorrected steps \
        is at most {UNCORRECTED} times that of Gauss; and the trajectory error is at most {TRAJECTORY} times that of \
        Gauss (for unresolved fast oscillations, the error of the slow variables).\n\n\
        A row whose trajectory error is known to exceed this limit is a known deficit. It does not fail.\n\n\
        Exit codes: 0 no row failed; 1 a row failed, or the output failed; 2 invalid usage.\n\n\
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
