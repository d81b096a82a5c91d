//! The program `equip`: the scenes of the catalogue, integrated and drawn from the shell.
#![forbid(unsafe_code)]

mod args;
mod csv;
mod fault;
mod json;
mod plot;
mod progress;
mod run;
mod samples;
mod scenes;
mod svg;
mod watch;

use args::Command;
use std::process::ExitCode;

fn main() -> ExitCode {
    let done = match args::parse().command {
        Command::Scenes(args) => scenes::scenes(&args),
        Command::Run(args) => run::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            eprintln!("error: {fault}");
            fault.exit_code()
        }
    }
}
