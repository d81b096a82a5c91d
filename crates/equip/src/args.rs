//! Commands and options, and the help that teaches them.
//!
//! The parameters of a scene are options of `run` too (`--e 0.9`); they are added to the derived parser by name.

use clap::{Arg, Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use equip_scenes::Scene;
use std::ffi::OsString;
use std::path::PathBuf;

/// Heading of the options that are parameters of the scene.
const PARAMETERS: &str = "Parameters of the scene";

#[derive(Debug, Parser)]
#[command(
    name = "equip",
    version,
    about = "Energy-preserving integration of Hamiltonian systems",
    long_about = "Integrates named Hamiltonian systems with EQUIP methods: Gauss methods whose free parameters α are \
        chosen at every step so that the energy H is kept to round-off, and quadratic invariants with it.",
    after_help = "Examples:\n  equip scenes                       what there is to integrate\n  \
        equip scenes kepler                formula, parameters and source of one scene\n  \
        equip run kepler                   a run with its certificate\n  \
        equip run kepler --e 0.9 --stages 6 --periods 100 --plot kepler.svg\n  \
        equip check --quick                stiff and extreme cases, judged\n  \
        equip report --quick               error against run time, as a page"
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// List the scenes, or describe one
    Scenes(ScenesArgs),
    /// Integrate a scene and print what was kept
    Run(Box<RunArgs>),
    /// Draw the Poincaré section of Hénon and Heiles
    Section(SectionArgs),
    /// Draw how the error of Kepler's problem grows with time, EQUIP beside Gauss
    Growth(GrowthArgs),
    /// Run the catalogue of stiff and extreme cases, and judge every row
    Check(CheckArgs),
    /// Error against run time of EQUIP, Gauss and classical methods: a page, pictures and tables
    Report(ReportArgs),
}

#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  equip scenes\n  equip scenes henon-heiles")]
pub(crate) struct ScenesArgs {
    /// Scene to describe; all are listed if none is named
    pub(crate) name: Option<String>,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Numbers are decimals (0.05, 1e-3) or quotients (1/20), read in the precision of the run: with \
        --precision dd, 0.1 is 1/10 to 31 digits.\n\n\
        Exit codes: 0 success; 1 the integration or the output failed, with the output up to there written; 2 bad usage \
        or input.\n\n\
        Examples:\n  \
        equip run kepler --e 0.6 --periods 100 --plot kepler.svg\n  \
        equip run kepler --e 0.9 --stages 6 --periods 100 --out orbit.csv --every 10\n  \
        equip run henon-heiles --stages 4 --step 0.25 --until 1000 --method gauss\n  \
        equip run pendulum --precision dd --stages 8 --step 1/10 --until 50\n  \
        equip run kepler --e 0.9 --stages 8 --tolerance 1e-12 --periods 1000 --checkpoint kepler.checkpoint\n  \
        equip run henon-heiles --energy 1/8 --q2 -0.25 --p2 0 --stages 6 --tolerance 1e-10 --until 10000 --lyapunov\n  \
        equip run kepler --e 0.3 --periods 100 --target-error 1e-8\n  \
        equip run kepler --json | jq .energy.max_defect\n\n\
        `equip run SCENE --help` lists the parameters of that scene."
)]
pub(crate) struct RunArgs {
    /// Scene to integrate; `equip scenes` lists them
    pub(crate) scene: String,
    /// Set a parameter of the scene; `--NAME VALUE` does the same
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair, help_heading = PARAMETERS)]
    pub(crate) set: Vec<(String, String)>,
    /// Stages s: the order is 2s, the cost of a step grows like s², or s³ where
    /// Newton's method makes it
    #[arg(long, short, default_value_t = 4, help_heading = "Method")]
    pub(crate) stages: usize,
    /// equip | equip-last (the single α of the paper) | gauss (α = 0) | fixed-alpha[=VALUE] (0.02 if not given)
    #[arg(long, value_name = "METHOD", default_value = "equip", value_parser = method, help_heading = "Method")]
    pub(crate) method: MethodName,
    /// Step; the scene's suggestion if not given
    #[arg(
        long,
        value_name = "H",
        allow_hyphen_values = true,
        conflicts_with = "steps_per_period",
        help_heading = "Method"
    )]
    pub(crate) step: Option<String>,
    /// Step as the scene's period divided by N
    #[arg(
        long,
        value_name = "N",
        allow_hyphen_values = true,
        help_heading = "Method"
    )]
    pub(crate) steps_per_period: Option<String>,
    /// Variable steps that follow this tolerance, in place of a fixed step
    #[arg(
        long,
        value_name = "TOL",
        conflicts_with_all = ["step", "steps_per_period"],
        help_heading = "Method"
    )]
    pub(crate) tolerance: Option<String>,
    /// A fixed step for which the largest error of a position or momentum at the end is about ERROR, found by trial runs over one period of the scene (or
    /// the whole run if that is shorter than two); from there errors are taken to grow linearly, as they do for regular motion
    #[arg(
        long,
        value_name = "ERROR",
        conflicts_with_all = ["step", "steps_per_period", "tolerance"],
        help_heading = "Method"
    )]
    pub(crate) target_error: Option<String>,
    /// Time to end at; the scene's suggestion if not given
    #[arg(
        long,
        value_name = "T",
        allow_hyphen_values = true,
        conflicts_with = "periods",
        help_heading = "Method"
    )]
    pub(crate) until: Option<String>,
    /// Time to end at, in periods of the scene
    #[arg(
        long,
        value_name = "P",
        allow_hyphen_values = true,
        help_heading = "Method"
    )]
    pub(crate) periods: Option<String>,
    /// Numbers to compute in: f64 has 16 digits, dd (double-double) about 31
    #[arg(long, value_enum, default_value = "f64", help_heading = "Method")]
    pub(crate) precision: Precision,
    /// End the run with an error at the first step for which no α keeps the energy
    #[arg(long, help_heading = "Method")]
    pub(crate) refuse: bool,
    /// Carry a small deviation along and print the largest Lyapunov exponent and MEGNO (2 for regular motion, λt/2 for chaotic);
    /// with --out two more columns, with --plot two more panels
    #[arg(long, visible_alias = "megno", help_heading = "Output")]
    pub(crate) lyapunov: bool,
    /// Write the steps to FILE.csv: t, q, p, energy defect, outcome, with digits that read back exactly
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub(crate) out: Option<PathBuf>,
    /// Write every K-th step only (the last one always)
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..), help_heading = "Output")]
    pub(crate) every: u64,
    /// Draw orbit or phase portrait, and the energy defect over time
    #[arg(long, value_name = "FILE.svg", help_heading = "Output")]
    pub(crate) plot: Option<PathBuf>,
    /// Leave out the Gauss method's energy defect on the same steps, which the plot shows for comparison
    #[arg(long, help_heading = "Output")]
    pub(crate) no_compare: bool,
    /// Keep a checkpoint in FILE; if there is one already, go on from it, bit for bit as if the run had not stopped. Ctrl-C leaves one
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Seconds between checkpoints
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 10.0,
        requires = "checkpoint",
        help_heading = "Output"
    )]
    pub(crate) checkpoint_every: f64,
    /// Print the certificate as JSON
    #[arg(long, help_heading = "Output")]
    pub(crate) json: bool,
    /// Print no certificate and no progress
    #[arg(long, short, conflicts_with = "json", help_heading = "Output")]
    pub(crate) quiet: bool,
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
    #[arg(long, value_name = "E", default_value = "1/8")]
    pub(crate) energy: String,
    /// Number of orbits
    #[arg(long, value_name = "N", default_value_t = 24)]
    pub(crate) orbits: usize,
    /// Time to end at, for each orbit
    #[arg(long, value_name = "T", default_value = "2000")]
    pub(crate) until: String,
    /// Stages s: the order is 2s
    #[arg(long, short, default_value_t = 8, help_heading = "Method")]
    pub(crate) stages: usize,
    /// Tolerance of the variable steps
    #[arg(
        long,
        value_name = "TOL",
        default_value = "1e-11",
        help_heading = "Method"
    )]
    pub(crate) tolerance: String,
    /// Where to draw
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
        default_value = "0.6,0.9,0.99,0.999"
    )]
    pub(crate) eccentricities: Vec<String>,
    /// Tolerances of the variable steps
    #[arg(
        long,
        value_name = "TOL,TOL,…",
        value_delimiter = ',',
        default_value = "1e-12,1e-14",
        help_heading = "Method"
    )]
    pub(crate) tolerances: Vec<String>,
    /// Revolutions to make
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub(crate) revolutions: u64,
    /// Stages s: the order is 2s
    #[arg(long, short, default_value_t = 8, help_heading = "Method")]
    pub(crate) stages: usize,
    /// Where to draw
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
    after_help = "Every row is integrated with EQUIP and with Gauss on the same steps. It passes if every step is accounted \
        for, the energy is within 8 round-off floors wherever it is said to be kept, quadratic invariants are at round-off, \
        no step is carried but for a reason that the row names, and the trajectory error is at most 1.5 times that of Gauss (2 times for the slow variables \
        where oscillations are not resolved).\n\n\
        Exit codes: 0 no row failed; 1 a row failed or the output did; 2 bad usage.\n\n\
        Examples:\n  \
        equip check --quick\n  \
        equip check --only fpu\n  \
        equip check --html check.html --json check.json"
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
    after_help = "For each scene: error at the end and energy defect against run time, work counts, and the time to given \
        errors, of EQUIP and Gauss with several numbers of stages, Störmer-Verlet, compositions of order 8 and 10, and DOP853. All use \
        the gradient derived from H.\n\n\
        The directory gets report.html, which needs nothing else, runs.csv, times.csv, and one SVG file a scene.\n\n\
        Examples:\n  \
        equip report --quick\n  \
        equip report --only kepler --out kepler-report\n  \
        equip report --peers benches/peers/out/peers.json"
)]
pub(crate) struct ReportArgs {
    /// Fewer scenes and methods, in less than a minute; all of it takes less than ten
    #[arg(long)]
    pub(crate) quick: bool,
    /// Scenes whose name, like kepler-0.6-f64 or pendulum-dd, contains TEXT
    #[arg(long, value_name = "TEXT")]
    pub(crate) only: Option<String>,
    /// Time to spend; more of it means finer settings and more repeats
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
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

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Precision {
    F64,
    Dd,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum MethodName {
    Equip,
    EquipLast,
    Gauss,
    FixedAlpha(String),
}

/// Parses the command line; ends the program on `--help` and on wrong usage.
pub(crate) fn parse() -> Cli {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let named = arguments
        .iter()
        .skip(2)
        .find_map(|text| equip_scenes::find(text.to_str()?).ok());
    let mut names = Vec::new();
    let command =
        Cli::command().mut_subcommand("run", |run| with_parameters(run, named, &mut names));
    let mut matches = command.clone().get_matches_from(arguments);
    let given: Vec<_> = match matches.subcommand_matches("run") {
        Some(run) => names
            .iter()
            .filter_map(|name| Some((name.to_string(), run.get_one::<String>(name)?.clone())))
            .collect(),
        None => Vec::new(),
    };
    let mut cli = Cli::from_arg_matches_mut(&mut matches).unwrap_or_else(|error| error.exit());
    if let Command::Run(run) = &mut cli.command {
        run.set.extend(given);
    }
    cli
}

/// Adds the parameters of all scenes as options, those of the scene `named` visibly; a parameter that has the name of
/// an option of `run` is left to `--set`.
fn with_parameters(
    mut run: clap::Command,
    named: Option<&'static Scene>,
    names: &mut Vec<&'static str>,
) -> clap::Command {
    let rest = equip_scenes::all()
        .iter()
        .filter(|scene| named.is_none_or(|n| n.name != scene.name));
    for (visible, scene) in named
        .into_iter()
        .map(|s| (true, s))
        .chain(rest.map(|s| (false, s)))
    {
        for parameter in scene.parameters {
            let name = parameter.name;
            let taken = |arg: &Arg| arg.get_id() == name || arg.get_long() == Some(name);
            if ["help", "version"].contains(&name) || run.get_arguments().any(taken) {
                continue;
            }
            names.push(name);
            run = run.arg(
                Arg::new(name)
                    .long(name)
                    .value_name("VALUE")
                    .allow_hyphen_values(true)
                    .hide(!visible)
                    .help(format!(
                        "{}, in {} [default: {}]",
                        parameter.meaning, parameter.range, parameter.default
                    ))
                    .help_heading(PARAMETERS),
            );
        }
    }
    run
}

fn seconds(text: &str) -> Result<f64, &'static str> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 1e6 => Ok(x),
        _ => Err("a positive number of seconds, at most 1e6"),
    }
}

fn pair(text: &str) -> Result<(String, String), &'static str> {
    let (name, value) = text
        .split_once('=')
        .ok_or("write it as NAME=VALUE, like e=0.9")?;
    Ok((name.trim().to_owned(), value.trim().to_owned()))
}

fn method(text: &str) -> Result<MethodName, &'static str> {
    match text.split_once('=') {
        None => match text {
            "equip" => Ok(MethodName::Equip),
            "equip-last" => Ok(MethodName::EquipLast),
            "gauss" => Ok(MethodName::Gauss),
            "fixed-alpha" => Ok(MethodName::FixedAlpha("0.02".into())),
            _ => Err("choose equip, equip-last, gauss or fixed-alpha=VALUE"),
        },
        Some(("fixed-alpha", value)) => Ok(MethodName::FixedAlpha(value.into())),
        Some(_) => Err("only fixed-alpha takes a value"),
    }
}

#[cfg(test)]
mod tests {
    use super::{Cli, MethodName, method, with_parameters};
    use clap::CommandFactory;

    #[test]
    fn the_parser_is_sound_with_the_parameters_of_every_scene() {
        for scene in equip_scenes::all() {
            let mut names = Vec::new();
            Cli::command()
                .mut_subcommand("run", |run| with_parameters(run, Some(scene), &mut names))
                .debug_assert();
            // Every parameter has its option: none is hidden behind an option of `run`.
            assert!(
                scene.parameters.iter().all(|p| names.contains(&p.name)),
                "{}",
                scene.name
            );
        }
    }

    #[test]
    fn method_names() {
        assert_eq!(
            method("fixed-alpha=-1/50"),
            Ok(MethodName::FixedAlpha("-1/50".into()))
        );
        assert_eq!(
            method("fixed-alpha"),
            Ok(MethodName::FixedAlpha("0.02".into()))
        );
        assert!(method("gauss=2").is_err() && method("euler").is_err());
    }
}
