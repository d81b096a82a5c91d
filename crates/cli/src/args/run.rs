//! Options of `equip run`.

use super::shared::{picture, stages, whole};
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
        Exit codes: 0 success; 1 the integration or the output failed (the output up to the failure is written); 2 \
        invalid usage or input; 128 + n ended by signal n (130 by Ctrl-C).\n\n\
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
    /// Set a parameter of the scene; `--NAME VALUE` does the same unless an option has that name
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair, help_heading = PARAMETERS)]
    pub(crate) set: Vec<(String, String)>,
    /// Number of stages s; the order is 2s. The cost of a step grows like s², with Newton's method like s³
    #[arg(long, short, default_value_t = 8, allow_negative_numbers = true, value_parser = stages, help_heading = "Method")]
    pub(crate) stages: usize,
    /// equip | equip-last (the single α of the paper) | gauss (α = 0) | fixed-alpha[=VALUE] (default 0.02) |
    /// hbvm=K,S (K nodes, degree S) | avf (averaged vector field) | trapezoidal=K (K nodes); the last three
    /// ignore --stages
    #[arg(long, value_name = "METHOD", default_value = "equip", value_parser = method, help_heading = "Method")]
    pub(crate) method: MethodName,
    /// Fixed step size; negative for a run backward in time
    #[arg(
        long,
        value_name = "H",
        allow_hyphen_values = true,
        help_heading = "Method"
    )]
    pub(crate) step: Option<String>,
    /// Variable steps with an error estimate of at most TOL relative to the change over the step; without a
    /// step size, the default is 1e-12 (1e-24 in double-double)
    #[arg(
        long,
        value_name = "TOL",
        allow_hyphen_values = true,
        conflicts_with = "step",
        help_heading = "Method"
    )]
    pub(crate) tolerance: Option<String>,
    /// Fixed step size: the period of the scene divided by N
    #[arg(
        long,
        value_name = "N",
        allow_hyphen_values = true,
        conflicts_with_all = ["step", "tolerance"],
        help_heading = "Method"
    )]
    pub(crate) steps_per_period: Option<String>,
    /// Fixed step size for which the largest error of q and p at the end is about ERROR. Trial runs over one
    /// period of the scene (over the entire run if it is shorter than two periods) determine the step size.
    /// After one period the errors are assumed to grow linearly, as in regular motion
    #[arg(
        long,
        value_name = "ERROR",
        allow_hyphen_values = true,
        conflicts_with_all = ["step", "steps_per_period", "tolerance"],
        help_heading = "Method"
    )]
    pub(crate) target_error: Option<String>,
    /// End time; the run begins at 0, and goes backward in time if T is negative. The default depends on the
    /// scene
    #[arg(
        long,
        value_name = "T",
        allow_hyphen_values = true,
        conflicts_with = "periods",
        help_heading = "Method"
    )]
    pub(crate) until: Option<String>,
    /// End time in periods of the scene; negative for a run backward in time
    #[arg(
        long,
        value_name = "P",
        allow_hyphen_values = true,
        help_heading = "Method"
    )]
    pub(crate) periods: Option<String>,
    /// Floating-point type: f64 has 16 digits, dd (double-double) about 31
    #[arg(long, value_enum, default_value = "f64", help_heading = "Method")]
    pub(crate) precision: Precision,
    /// Limit on the change of the end point y₁ caused by α. within-error: if the change would be much larger
    /// than the local error, the step is left uncorrected. always: no limit. refuse: the run ends with an
    /// error where within-error would leave a step uncorrected
    #[arg(
        long,
        value_enum,
        default_value = "within-error",
        help_heading = "Method"
    )]
    pub(crate) alpha_policy: AlphaPolicyName,
    /// Propagate a tangent vector and print the largest Lyapunov exponent λ and MEGNO (2 for regular motion,
    /// λt/2 for chaotic motion). Adds two columns to --out and two panels to --plot
    #[arg(long, visible_alias = "megno", help_heading = "Output")]
    pub(crate) lyapunov: bool,
    /// Write the steps to FILE.csv: t, q, p, energy error and outcome, with all digits
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub(crate) out: Option<PathBuf>,
    /// Write only every K-th step and the last one
    #[arg(long, value_name = "K", default_value_t = 1, allow_negative_numbers = true, value_parser = whole(1, u64::MAX), help_heading = "Output")]
    pub(crate) every: u64,
    /// Draw the orbit or phase portrait and the relative energy error over time. If the name ends in .html,
    /// the picture is a page whose panels stack in a narrow window
    #[arg(long, value_name = "FILE.svg", value_parser = picture, help_heading = "Output")]
    pub(crate) plot: Option<PathBuf>,
    /// Omit the energy error of Gauss (same steps or tolerance) from the plot
    #[arg(long, help_heading = "Output")]
    pub(crate) no_compare: bool,
    /// Write checkpoints to FILE, also after Ctrl-C and at the end of the run. If FILE exists, the run
    /// resumes from it, with the same bits as an uninterrupted run
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
pub(crate) enum AlphaPolicyName {
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
