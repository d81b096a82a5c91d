//! [`Fault`]: why the program ends without success, and with which exit code.

use crate::text::significant;
use equip_integrate::{IntegrateError, RunFailure};
use equip_scalar::{Float, ParseFloatError};
use equip_scenes::SceneError;
use std::path::PathBuf;
use std::process::ExitCode;

/// Exit code of a run that began and could not be finished, its output up to there written, and of a failed
/// check.
const INTEGRATION_FAILED: u8 = 1;
/// Exit code of wrong usage and bad input, the same as that of the argument parser.
const BAD_INPUT: u8 = 2;

#[derive(Debug, thiserror::Error)]
pub(crate) enum Fault {
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error("{option}: {source}")]
    Number {
        option: &'static str,
        source: ParseFloatError,
    },
    #[error("{option} is {value}; it must be {expected}")]
    Option {
        option: &'static str,
        value: String,
        expected: &'static str,
    },
    #[error("cannot write {}: {source}; choose another path or create its directory", path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error(
        "cannot write all of {}: {source}; free disk space, or raise the file size limit (ulimit -f){advice}",
        path.display()
    )]
    NoRoom {
        path: PathBuf,
        source: std::io::Error,
        advice: &'static str,
    },
    #[error("cannot read {}: {source}; check the path and its permissions", path.display())]
    Read {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("{} is not a checkpoint of this program: {what}; name another file with --checkpoint", path.display())]
    NotACheckpoint { path: PathBuf, what: &'static str },
    #[error(
        "the checkpoint {} belongs to another run: its {what} is {stored}, now it is {now}; repeat that command, or name another file with --checkpoint",
        path.display()
    )]
    OtherRun {
        path: PathBuf,
        what: String,
        stored: String,
        now: String,
    },
    #[error(
        "cannot continue the table {}: {what}; give the table that was written with this checkpoint, or start again with another --checkpoint",
        path.display()
    )]
    Table { path: PathBuf, what: String },
    #[error("{} and {} name the same file {}; name two files", .options.0, .options.1, path.display())]
    SameFile {
        options: (&'static str, &'static str),
        path: PathBuf,
    },
    #[error(
        "{} is being written by another program; wait until that program has ended, or name another file",
        path.display()
    )]
    InUse { path: PathBuf },
    #[error("ended by signal {signal} at t = {reached}; {next}")]
    Interrupted {
        signal: i32,
        exit_code: u8,
        reached: String,
        next: String,
    },
    #[error("cannot print: {0}")]
    Print(#[from] std::io::Error),
    #[error("{0}")]
    Start(Box<dyn std::error::Error>),
    #[error("{cause}\nthe run ended at t = {reached}; {written}")]
    Integration {
        cause: Box<dyn std::error::Error>,
        reached: String,
        written: &'static str,
    },
    #[error("{failed} of {rows} rows failed; the table has the reasons")]
    Check { failed: usize, rows: usize },
    #[error("{failed} of {rows} statements do not hold; the table shows which")]
    Statements { failed: usize, rows: usize },
}

impl Fault {
    /// An option with a value that it does not take.
    pub(crate) fn option(
        option: &'static str,
        value: impl ToString,
        expected: &'static str,
    ) -> Self {
        let value = value.to_string();
        Fault::Option {
            option,
            value,
            expected,
        }
    }

    /// A fault found before the first step.
    pub(crate) fn start<T: Float>(error: IntegrateError<T>) -> Self {
        Fault::Start(in_flags(&error).into())
    }

    /// A fault of a run that reached `reached`.
    pub(crate) fn integration<T: Float>(
        error: &IntegrateError<T>,
        reached: f64,
        written: &'static str,
    ) -> Self {
        Fault::Integration {
            cause: in_flags(error).into(),
            reached: significant(reached, 7),
            written,
        }
    }

    /// A fault of a run that is drawn when it is finished.
    pub(crate) fn undrawn(failure: RunFailure<f64>) -> Self {
        match failure.partial {
            None => Fault::start(failure.error),
            Some(partial) => {
                let reached = partial.certificate().end;
                Fault::integration(&failure.error, reached, "nothing was drawn")
            }
        }
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Fault::Interrupted { exit_code, .. } => *exit_code,
            Fault::NoRoom { .. }
            | Fault::Integration { .. }
            | Fault::Check { .. }
            | Fault::Statements { .. }
            | Fault::Write { .. }
            | Fault::Print(_) => INTEGRATION_FAILED,
            _ => BAD_INPUT,
        })
    }
}

/// The text of an error of the library, with the flags of the program where it names options of the library.
fn in_flags<T: Float>(error: &IntegrateError<T>) -> String {
    use IntegrateError as E;
    match error {
        E::StagesOutOfRange { stages, min, max } => {
            format!(
                "--stages, or a number in --method, is {stages}; this method accepts {min} to {max}"
            )
        }
        E::Option {
            option,
            value,
            expected,
        } => {
            let flag = option.replace('_', "-");
            format!("--{flag} is {value}; it must be {expected}")
        }
        E::StepOutOfRange { step } => {
            format!("--step is {step}; it must be finite and not zero")
        }
        E::StepsLeadAway { step, end, .. } => format!(
            "--until or --periods is t = {end}, but steps of {step} lead away from it: give --step without a sign; a run resumed from a checkpoint keeps its direction"
        ),
        E::Interval { start, end } => format!(
            "--until or --periods leads to a run from t = {start} to t = {end}; both times must be finite"
        ),
        E::StepLimit { steps, time } => format!(
            "the limit of {steps} steps is reached at t = {time}; loosen --tolerance, or end earlier with --until"
        ),
        E::CheckpointMismatch { what, stored, now } if *what == "alpha_policy" => format!(
            "the checkpoint was made with --alpha-policy {}, this run has {}; give the same, or start again with another --checkpoint",
            in_kebab_case(stored),
            in_kebab_case(now)
        ),
        E::CheckpointMismatch { what, now, .. } if *what == "tangent vector" => {
            of_flag("--lyapunov", now == "followed")
        }
        E::NoAdmissibleAlpha {
            time,
            step,
            energy_error,
            round_off,
        } => format!(
            "no admissible α conserves the energy in the step at t = {time}, h = {step} (energy error {energy_error:e}, round-off level {round_off:e}); use a smaller --step, more --stages or --method equip, or omit --alpha-policy refuse to accept uncorrected steps"
        ),
        other => other.to_string(),
    }
}

/// `WithinError` as the command line has it.
fn in_kebab_case(name: &str) -> String {
    let mut text = String::new();
    for c in name.chars() {
        if c.is_uppercase() && !text.is_empty() {
            text.push('-');
        }
        text.extend(c.to_lowercase());
    }
    text
}

/// The checkpoint was made without a flag that this run has, or with a flag that this run lacks.
fn of_flag(flag: &str, is_given: bool) -> String {
    let (before, now, change) = if is_given {
        ("without", "has it", "omit it")
    } else {
        ("with", "lacks it", "give it")
    };
    format!(
        "the checkpoint was made {before} {flag}, this run {now}; {change}, or start again with another --checkpoint"
    )
}

#[cfg(test)]
mod tests {
    use super::Fault;
    use std::process::ExitCode;

    #[test]
    fn a_failed_row_fails_the_program() {
        let fault = Fault::Check { failed: 1, rows: 3 };
        // Exit codes can only be compared as they print.
        let code = |code: ExitCode| format!("{code:?}");
        assert_eq!(code(fault.exit_code()), code(ExitCode::from(1)));
        assert!(fault.to_string().starts_with("1 of 3 rows failed"));
    }
}
