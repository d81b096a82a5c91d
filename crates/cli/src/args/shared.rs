//! Options that commands over a scene share: the problem, the method with its steps, the span of time.

use crate::fault::Fault;
use clap::Args;
use equip_integrate::MAX_STAGES;
use equip_scenes::Instance;
use std::fmt;

/// Heading of the options that are parameters of the scene.
pub(super) const PARAMETERS: &str = "Parameters of the scene";

#[derive(Debug, Args)]
pub(crate) struct Problem {
    /// Scene to integrate; `equip scenes` lists them
    pub(crate) scene: String,
    /// Set a parameter of the scene; `--NAME VALUE` does the same where no option here has that name
    #[arg(long, value_name = "NAME=VALUE", value_parser = pair, help_heading = PARAMETERS)]
    pub(crate) set: Vec<(String, String)>,
}

impl Problem {
    /// The scene with its parameters.
    pub(crate) fn instance(&self) -> Result<Instance, Fault> {
        let scene = equip_scenes::find(&self.scene)?;
        let values = self.set.iter().map(|(n, v)| (n.as_str(), v.as_str()));
        Ok(scene.instance(&values.collect::<Vec<_>>())?)
    }
}

#[derive(Debug, Args)]
pub(crate) struct Stepping {
    /// Stages s: the order is 2s, the cost of a step grows like s², or s³ where
    /// Newton's method makes it
    #[arg(long, short, default_value_t = 8, allow_negative_numbers = true, value_parser = stages, help_heading = "Method")]
    pub(crate) stages: usize,
    /// equip | equip-last (the single α of the paper) | gauss (α = 0) | fixed-alpha[=VALUE] (0.02 if not
    /// given)
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
}

#[derive(Debug, Args)]
pub(crate) struct Span {
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
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum MethodName {
    Equip,
    EquipLast,
    Gauss,
    FixedAlpha(String),
}

impl fmt::Display for MethodName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            MethodName::Equip => f.write_str("equip"),
            MethodName::EquipLast => f.write_str("equip-last"),
            MethodName::Gauss => f.write_str("gauss"),
            MethodName::FixedAlpha(alpha) => write!(f, "fixed-alpha={alpha}"),
        }
    }
}

/// Reads whole numbers from `low` to `high`; others are refused with these.
pub(super) fn whole(low: u64, high: u64) -> impl Fn(&str) -> Result<u64, String> + Clone {
    move |text| match text.trim().parse() {
        Ok(number) if (low..=high).contains(&number) => Ok(number),
        _ if high == u64::MAX => Err(format!("a whole number, {low} or more")),
        _ => Err(format!("a whole number from {low} to {high}")),
    }
}

/// Reads a number of stages; which of them a method takes is known by the method.
pub(super) fn stages(text: &str) -> Result<usize, String> {
    match text.trim().parse() {
        Ok(stages) if stages >= 1 => Ok(stages),
        _ => Err(format!("a whole number from 1 to {MAX_STAGES}")),
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
    use super::{MethodName, method};

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
