//! The runs and the times to accuracies as comma-separated values; numbers with all their digits, what is not
//! known left empty.

use super::accuracy::Time;
use super::results::{Results, times};
use crate::write::csv::cell;
use std::fmt::Write;

/// Every run of every scene. Errors of invariants stand in one cell, `name=value` joined by semicolons.
pub(super) fn runs(results: &[Results]) -> String {
    let mut text = String::from(
        "scene,precision,method,order,setting,steps,error,energy_error,invariant_errors,gradients,iterations,\
         milliseconds,least,most,repeats,uncorrected\n",
    );
    for result in results {
        for curve in &result.curves {
            for point in &curve.points {
                let o = &point.outcome;
                let named = result.invariants.iter().zip(&o.invariants);
                let invariants: Vec<_> = named
                    .map(|(name, x)| format!("{name}={}", cell(*x)))
                    .collect();
                let (least, most) = point.spread();
                // Writing to a String does not fail.
                let _ = writeln!(
                    text,
                    "{},{},{},{},{},{},{},{},\"{}\",{},{},{},{},{},{},{}",
                    result.name,
                    result.precision,
                    curve.contender.name(),
                    curve.contender.order(),
                    point.setting,
                    o.steps,
                    cell(o.error),
                    cell(o.energy),
                    invariants.join(";"),
                    o.gradients,
                    o.iterations,
                    cell(point.median()),
                    cell(least),
                    cell(most),
                    point.milliseconds.len(),
                    o.uncorrected
                );
            }
        }
    }
    text
}

/// Milliseconds of every method to every target.
pub(super) fn accuracies(results: &[Results]) -> String {
    let mut text = String::from("scene,precision,method,target,milliseconds,how\n");
    for result in results {
        for curve in &result.curves {
            for (target, time) in result.targets.iter().zip(times(curve, result.targets)) {
                let how = match time {
                    Time::Interpolated(_) => "interpolated",
                    Time::AtMost(_) => "at most",
                    Time::NotReached => "not reached",
                };
                let ms = time.milliseconds().map_or(String::new(), cell);
                let name = curve.contender.name();
                let _ = writeln!(
                    text,
                    "{},{},{name},{target:e},{ms},{how}",
                    result.name, result.precision
                );
            }
        }
    }
    text
}
