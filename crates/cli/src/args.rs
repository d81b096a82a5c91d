//! Commands and options, and the help that teaches them.
//!
//! The parameters of a scene are options of `run` too (`--e 0.9`); they are added to the derived parser by
//! name.

mod number;
mod others;
mod run;
mod shared;

pub(crate) use number::{number, positive};
pub(crate) use others::{CheckArgs, GrowthArgs, PaperArgs, ReportArgs, ScenesArgs, SectionArgs};
pub(crate) use run::{AlphaPolicyName, MethodName, Precision, RunArgs};

use clap::{Arg, CommandFactory, FromArgMatches, Parser, Subcommand};
use equip_scenes::Scene;
use run::PARAMETERS;
use std::ffi::OsString;

#[derive(Debug, Parser)]
#[command(
    name = "equip",
    version,
    about = "Energy-preserving integration of Hamiltonian systems",
    long_about = "Integrates named Hamiltonian systems with EQUIP methods: Gauss methods with free parameters α. \
        Each step first computes the Gauss step (α = 0). If its energy error exceeds the round-off level, the solver \
        determines the parameters α so that H returns to its initial value. Quadratic invariants are conserved too.",
    after_help = "Examples:\n  equip scenes                       the scenes: named test problems\n  \
        equip scenes kepler                formula, parameters and source of one scene\n  \
        equip run kepler                   a run with its certificate\n  \
        equip run kepler --e 0.9 --stages 6 --periods 100 --plot kepler.svg\n  \
        equip check --quick                stiff and extreme cases, each with a verdict\n  \
        equip paper --html paper.html      the paper's statements, measured\n  \
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
    /// Integrate a scene and print the certificate: what was conserved
    Run(Box<RunArgs>),
    /// Draw the Poincaré section of the Hénon–Heiles system
    Section(SectionArgs),
    /// Draw the growth of the error of Kepler's problem with time, for EQUIP and Gauss
    Growth(GrowthArgs),
    /// Test EQUIP on a catalogue of stiff and extreme cases
    Check(CheckArgs),
    /// Verify the statements of the paper with its own method, a single α
    Paper(PaperArgs),
    /// Plot error against run time for EQUIP and Gauss: a page, pictures and tables
    Report(ReportArgs),
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
    let mut matches = command.get_matches_from(arguments);
    let mut given = Vec::new();
    if let Some(values) = matches.subcommand_matches("run") {
        let value = |name: &str| values.get_one::<String>(name).cloned();
        let named = names.into_iter();
        given.extend(named.filter_map(|name| Some((name.to_string(), value(name)?))));
    }
    let mut cli = Cli::from_arg_matches_mut(&mut matches).unwrap_or_else(|error| error.exit());
    if let Command::Run(run) = &mut cli.command {
        run.set.extend(given);
    }
    cli
}

/// Adds the parameters of all scenes as options, those of the scene `named` visibly; a parameter that has the
/// name of an option of `run` is left to `--set`.
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

#[cfg(test)]
mod tests {
    use super::{Cli, with_parameters};
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
}
