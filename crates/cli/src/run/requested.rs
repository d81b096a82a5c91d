//! Options that do not go together, and those that change nothing.

use crate::args::{AlphaPolicyName, MethodName, RunArgs};
use crate::fault::Fault;
use crate::text::say;
use crate::write::checkpoint::unfinished;
use crate::write::lock::beside;
use crate::write::outputs::{apart, printed};

/// Refuses two outputs in one file, and says which options change nothing.
///
/// # Errors
/// [`Fault::SameFile`].
pub(crate) fn check(args: &RunArgs) -> Result<(), Fault> {
    let checkpoint = args.checkpoint.as_deref();
    let new = checkpoint.map(unfinished);
    let lock = checkpoint.map(beside);
    let (name, standard) = printed();
    apart(&[
        ("--out", args.out.as_deref()),
        ("--plot", args.plot.as_deref()),
        ("--checkpoint", checkpoint),
        ("--checkpoint, while it is written,", new.as_deref()),
        ("--checkpoint, by its lock,", lock.as_deref()),
        (name, standard.filter(|_| !args.quiet)),
    ])?;
    for (option, why) in without_effect(args) {
        say(&format!("note: {option} has no effect: {why}"));
    }
    Ok(())
}

/// Options given that change nothing, and why.
fn without_effect(args: &RunArgs) -> Vec<(&'static str, &'static str)> {
    let asks_for_energy = matches!(args.method, MethodName::Equip | MethodName::EquipLast);
    let has_file = [&args.out, &args.plot, &args.checkpoint]
        .into_iter()
        .any(Option::is_some);
    let rules = [
        (
            "--every",
            args.every != 1 && args.out.is_none(),
            "there is no --out",
        ),
        (
            "--no-compare",
            args.no_compare && args.plot.is_none(),
            "there is no --plot",
        ),
        (
            "--no-compare",
            args.no_compare && args.plot.is_some() && args.method == MethodName::Gauss,
            "Gauss is not compared with itself",
        ),
        (
            "--lyapunov",
            args.lyapunov && args.quiet && !has_file,
            "with --quiet nothing is printed, and there is no --out, --plot or --checkpoint",
        ),
        (
            "--alpha-policy",
            args.alpha_policy != AlphaPolicyName::WithinError && !asks_for_energy,
            "this method does not solve for α",
        ),
    ];
    let given = rules.into_iter().filter(|(_, is_given, _)| *is_given);
    given.map(|(option, _, why)| (option, why)).collect()
}
