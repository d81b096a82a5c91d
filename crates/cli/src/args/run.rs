//! Options of `equip run`.

use super::shared::{stages, whole};
use crate::fault::Fault;
use clap::{Args, ValueEnum};
use equip_integrate::Method;
use equip_scenes::Instance;
use std::path::PathBuf;

/// Heading of the options that are parameters of the scene.
pub(super) const PARAMETERS: &str = "Parameters of the scene";

#[derive(Debug, Args)]
#[command(
    after_help = "Numbers are decimals (0.05, 1e-3) or quotients (1/20), read in the precision of the run: with \
        --precision dd, 0.1 is 1/10 to 31 digits.\n\n\
        Exit codes: 0 success; 1 the integration or the output failed, with the output up to there written; 2 bad usage \
        or input; 128 + n ended by signal n (130 by Ctrl-C).\n\n\
        Examples:\n  \
        equip run kepler --e 0.6 --periods 100 --stages 4 --tolerance 1e-6 --plot kepler.svg\n  \
        equip run kepler --e 0.9 --stages 6 --periods 100 --out orbit.csv --every 10\n  \
        equip run henon-heiles --stages 4 --step 0.25 --until 1000 --method gauss\n  \
        equip run pendulum --precision dd --stages 8 --step 1/10 --until 50\n  \
        equip run kepler --e 0.9 --stages 8 --tolerance 1e-12 --periods 1000 --checkpoint kepler.checkpoint\n  \
        equip run henon-heiles --energy 1/8 --q2 -0.25 --p2 0 --stages 6 --tolerance 1e-10 --until 10000 --lyapunov\n  \
        equip run kepler --e 0.3 --periods 100 --target-error 1e-8\n  \
        equip run kepler --json | jq .energy.max\n\n\
        `equip run SCENE --help` lists the parameters of that scene."
)]
pub(crate) struct RunArgs {
    /// Scene to integrate; `equip scenes` lists them
    pub(crate) scene: String,
    /// Set a parameter of the scene; `--NAME VALUE` does the same where no option here has that name
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair, help_heading = PARAMETERS)]
    pub(crate) set: Vec<(String, String)>,
    /// Stages s: the order is 2s, the cost of a step grows like s², or s³ where
    /// Newton's method makes it
    #[arg(long, short, default_value_t = 8, allow_negative_numbers = true, value_parser = stages, help_heading = "Method")]
    pub(crate) stages: usize,
    /// equip | equip-last (the single α of the paper) | gauss (α = 0) | fixed-alpha[=VALUE] (0.02 if not
    /// given) | hbvm=K,S (K nodes, degree S) | avf (averaged vector field) | trapezoidal=K (K nodes); the
    /// last three leave --stages out of account
    #[arg(long, value_name = "METHOD", default_value = "equip", value_parser = method, help_heading = "Method")]
    pub(crate) method: MethodName,
    /// Fixed step, positive or, back in time, negative
    #[arg(
        long,
        value_name = "H",
        allow_hyphen_values = true,
        help_heading = "Method"
    )]
    pub(crate) step: Option<String>,
    /// Variable steps whose local error relative to the change over the step is at most TOL; 1e-12 if no step
    /// is given either (1e-24 in double-double)
    #[arg(
        long,
        value_name = "TOL",
        allow_hyphen_values = true,
        conflicts_with = "step",
        help_heading = "Method"
    )]
    pub(crate) tolerance: Option<String>,
    /// Step as the scene's period divided by N
    #[arg(
        long,
        value_name = "N",
        allow_hyphen_values = true,
        conflicts_with_all = ["step", "tolerance"],
        help_heading = "Method"
    )]
    pub(crate) steps_per_period: Option<String>,
    /// A fixed step for which the largest error of a position or momentum at the end is about ERROR, found by
    /// trial runs over one period of the scene (or the whole run if that is shorter than two); from there
    /// errors are taken to grow linearly, as they do for regular motion
    #[arg(
        long,
        value_name = "ERROR",
        allow_hyphen_values = true,
        conflicts_with_all = ["step", "steps_per_period", "tolerance"],
        help_heading = "Method"
    )]
    pub(crate) target_error: Option<String>,
    /// Time to end at, from the start at 0; a negative one runs back in time; the scene's suggestion if not
    /// given
    #[arg(
        long,
        value_name = "T",
        allow_hyphen_values = true,
        conflicts_with = "periods",
        help_heading = "Method"
    )]
    pub(crate) until: Option<String>,
    /// Time to end at, in periods of the scene; negative back in time
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
    /// How far the parameters α may move the end of a step: within-error leaves the energy error of a step
    /// to a later one where α would move its end by more than some local errors; always moves it as far as
    /// it takes; refuse ends the run with an error where within-error would leave an energy error
    #[arg(
        long,
        value_enum,
        default_value = "within-error",
        help_heading = "Method"
    )]
    pub(crate) reach: ReachName,
    /// Carry a small deviation along and print the largest Lyapunov exponent and MEGNO (2 for regular motion,
    /// λt/2 for chaotic); with --out two more columns, with --plot two more panels
    #[arg(long, visible_alias = "megno", help_heading = "Output")]
    pub(crate) lyapunov: bool,
    /// Write the steps to FILE.csv: t, q, p, energy error, outcome, with digits that read back exactly
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub(crate) out: Option<PathBuf>,
    /// Write every K-th step only (the last one always)
    #[arg(long, value_name = "K", default_value_t = 1, allow_negative_numbers = true, value_parser = whole(1, u64::MAX), help_heading = "Output")]
    pub(crate) every: u64,
    /// Draw orbit or phase portrait, and the relative energy error over time; a page whose panels stack
    /// in a narrow window if the name ends in .html
    #[arg(long, value_name = "FILE.svg", help_heading = "Output")]
    pub(crate) plot: Option<PathBuf>,
    /// Leave out the energy error of Gauss with the same steps or tolerance, which the plot shows too
    #[arg(long, help_heading = "Output")]
    pub(crate) no_compare: bool,
    /// Keep a checkpoint in FILE; if there is one already, go on from it, bit for bit as if the run had not
    /// stopped. Ctrl-C leaves one, and so does the end of the run
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// Seconds between checkpoints
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 10.0,
        allow_negative_numbers = true,
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

impl RunArgs {
    /// The scene with its parameters.
    pub(crate) fn instance(&self) -> Result<Instance, Fault> {
        let scene = equip_scenes::find(&self.scene)?;
        let values = self.set.iter().map(|(n, v)| (n.as_str(), v.as_str()));
        Ok(scene.instance(&values.collect::<Vec<_>>())?)
    }

    /// The tolerance, given or not, unless the steps are fixed.
    pub(crate) fn tolerance(&self) -> Option<&str> {
        let is_fixed =
            self.step.is_some() || self.steps_per_period.is_some() || self.target_error.is_some();
        match &self.tolerance {
            Some(text) => Some(text),
            None => (!is_fixed).then(|| self.precision.tolerance()),
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum MethodName {
    Equip,
    EquipLast,
    Gauss,
    FixedAlpha(String),
    /// HBVM, averaged vector field, trapezoidal.
    Relative(Method),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReachName {
    WithinError,
    Always,
    Refuse,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Precision {
    F64,
    Dd,
}

impl Precision {
    /// The tolerance of a run for which no step is given.
    fn tolerance(self) -> &'static str {
        match self {
            Precision::F64 => "1e-12",
            Precision::Dd => "1e-24",
        }
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
            _ => relative(text),
        },
        Some(("fixed-alpha", value)) => Ok(MethodName::FixedAlpha(value.into())),
        Some(_) => relative(text),
    }
}

fn relative(text: &str) -> Result<MethodName, &'static str> {
    Method::named(text)
        .map(MethodName::Relative)
        .ok_or("choose equip, equip-last, gauss, fixed-alpha=VALUE, hbvm=K,S, avf or trapezoidal=K")
}

#[cfg(test)]
mod tests {
    use super::{MethodName, method};
    use equip_integrate::Method;

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
        let hbvm = Method::hbvm(6, 2);
        assert_eq!(method("hbvm=6,2"), Ok(MethodName::Relative(hbvm)));
        assert!(method("gauss=2").is_err() && method("euler").is_err());
        assert!(method("hbvm=6").is_err() && method("avf=3").is_err());
    }
}
