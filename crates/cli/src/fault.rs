//! [`Fault`]: why the program ends without success, and with which exit code.

use equip_integrate::IntegrateError;
use equip_scalar::{Float, ParseFloatError};
use equip_scenes::SceneError;
use std::path::PathBuf;
use std::process::ExitCode;

/// Exit code of a run that began and could not be finished, its output up to there written, and of a failed check.
const INTEGRATION_FAILED: u8 = 1;
/// Exit code of a run ended by Ctrl-C, as shells have it.
const INTERRUPTED: u8 = 130;
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
    #[error("cannot write {}: {source}; choose another path or make its directory", path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
    #[error("cannot read the checkpoint {}: {source}; remove it to start anew", path.display())]
    Checkpoint {
        path: PathBuf,
        source: serde_json::Error,
    },
    #[error("interrupted at t = {reached}; {next}")]
    Interrupted { reached: f64, next: String },
    #[error("cannot print: {0}")]
    Print(#[from] std::io::Error),
    #[error("{0}")]
    Start(Box<dyn std::error::Error>),
    #[error("{cause}\nthe run ended at t = {reached}; {written}")]
    Integration {
        cause: Box<dyn std::error::Error>,
        reached: f64,
        written: &'static str,
    },
    #[error("{failed} of {rows} rows failed; their reasons stand in the table")]
    Check { failed: usize, rows: usize },
}

impl Fault {
    /// A fault found before the first step.
    pub(crate) fn start<T: Float>(error: IntegrateError<T>) -> Self {
        Fault::Start(Box::new(error))
    }

    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Fault::Interrupted { .. } => INTERRUPTED,
            Fault::Integration { .. }
            | Fault::Check { .. }
            | Fault::Write { .. }
            | Fault::Print(_) => INTEGRATION_FAILED,
            _ => BAD_INPUT,
        })
    }
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
