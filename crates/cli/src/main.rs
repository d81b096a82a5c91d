//! The program `equip`: the scenes of the catalogue, integrated and drawn from the shell.
#![forbid(unsafe_code)]

mod args;
mod check;
mod commands;
mod draw;
mod fault;
mod limits;
mod paper;
mod report;
mod run;
mod text;
mod write;

use args::Command;
use commands::{growth, scenes, section};
use fault::Fault;
use run::signals;
use std::io::ErrorKind;
use std::process::ExitCode;

fn main() -> ExitCode {
    let done = signals::outlive_size_limit().and_then(|()| match args::parse().command {
        Command::Scenes(args) => scenes::scenes(&args),
        Command::Run(mut args) => run::run(&mut args),
        Command::Section(args) => section::section(&args),
        Command::Growth(args) => growth::growth(&args),
        Command::Check(args) => check::check(&args),
        Command::Paper(args) => paper::paper(&args),
        Command::Report(args) => report::report(&args),
    });
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // The reader of a pipe had enough: `equip scenes | head`.
        Err(Fault::Print(error)) if error.kind() == ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(fault) => {
            text::say(&format!(
                "error: {}",
                text::without_long_numbers(&fault.to_string())
            ));
            fault.exit_code()
        }
    }
}
