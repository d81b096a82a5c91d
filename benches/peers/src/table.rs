//! Results as a table for people, as CSV and as JSON.

use crate::race::Lane;
use crate::task::Task;
use serde_json::{Value, json};
use std::fmt::Write;

/// A program's quickest way to a target.
#[derive(Debug, Clone)]
pub struct Best {
    pub program: String,
    pub method: String,
    pub setting: f64,
    pub error: f64,
    /// Milliseconds: median, least, most.
    pub ms: (f64, f64, f64),
    pub rounds: usize,
}

/// A method of ours in two parts: how H is given and steps are chosen; stages and how they are solved.
fn variant(method: &str) -> (&str, &str) {
    method.split_once(": ").unwrap_or(("", method))
}

/// Groups contestants for the table: ours by the way H is given, peers by program.
fn group(lane: &Lane) -> String {
    let method = lane.contestant.method();
    match lane.contestant.program() {
        "equip" => format!("equip {}", variant(&method).0),
        program => program.to_owned(),
    }
}

/// Groups in the order in which they first stand.
pub fn groups(lanes: &[Lane]) -> Vec<String> {
    let mut names = Vec::new();
    for name in lanes.iter().map(group) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

impl Best {
    fn of(lane: &Lane, i: usize) -> Self {
        let tried = &lane.tried[i];
        let (median, low, high) = tried.spread();
        Best {
            program: lane.contestant.program().into(),
            method: lane.contestant.method(),
            setting: tried.setting,
            error: tried.error,
            ms: (1e3 * median, 1e3 * low, 1e3 * high),
            rounds: tried.seconds.len().saturating_sub(1).max(1),
        }
    }
}

/// The quickest of a group by what `which` picks of every contestant.
fn quickest(lanes: &[Lane], name: &str, which: impl Fn(&Lane) -> Option<usize>) -> Option<Best> {
    lanes
        .iter()
        .filter(|lane| group(lane) == name)
        .filter_map(|lane| Some(Best::of(lane, which(lane)?)))
        .min_by(|a, b| a.ms.0.total_cmp(&b.ms.0))
}

/// The quickest of a group to reach an error.
pub fn best(lanes: &[Lane], name: &str, target: f64) -> Option<Best> {
    quickest(lanes, name, |lane| lane.quickest(target))
}

/// The quickest that is not ours.
pub fn best_peer(lanes: &[Lane], target: f64) -> Option<Best> {
    groups(lanes)
        .iter()
        .filter(|name| !name.starts_with("equip"))
        .filter_map(|name| best(lanes, name, target))
        .min_by(|a, b| a.ms.0.total_cmp(&b.ms.0))
}

/// The table of one scene.
pub fn text(task: &Task, lanes: &[Lane]) -> String {
    let mut out = String::new();
    // Writing to a String does not fail.
    let _ = writeln!(
        out,
        "\n{} (reference within {:.0e}); CPU milliseconds to an error of",
        task.title, task.uncertainty
    );
    let _ = write!(out, "{:<24}", "");
    for target in task.targets {
        let _ = write!(out, "{:>42}", format!("{target:.0e}"));
    }
    let _ = writeln!(out);
    for name in groups(lanes) {
        let _ = write!(out, "{name:<24}");
        for &target in task.targets {
            let cell = match (best(lanes, &name, target), best_peer(lanes, target)) {
                (None, _) => "–".to_owned(),
                (Some(best), peer) => {
                    let ratio = peer
                        .filter(|_| best.program == "equip")
                        .map(|p| best.ms.0 / p.ms.0);
                    let ratio = ratio.map_or(String::new(), |r| format!(" ({r:.2})"));
                    let (_, method) = variant(&best.method);
                    format!(
                        "{:.3}{ratio} {method} {:.3}",
                        best.ms.0,
                        Setting(best.setting)
                    )
                }
            };
            let _ = write!(out, "{cell:>42}");
        }
        let _ = writeln!(out);
    }
    if let Some(tolerance) = task.tolerance {
        let _ = writeln!(out, "at tolerance {tolerance:.0e}:");
        for lane in lanes {
            let Some(at) = lane.at_tolerance(tolerance).map(|i| Best::of(lane, i)) else {
                continue;
            };
            let name = format!("{} {}", at.program, at.method);
            let _ = writeln!(
                out,
                "  {name:<44}{:>10.3} ms, error {:.1e}",
                at.ms.0, at.error,
            );
        }
    }
    for lane in lanes {
        let least = lane
            .tried
            .iter()
            .map(|t| t.error)
            .fold(f64::INFINITY, f64::min);
        let failure = lane
            .failure
            .as_deref()
            .map_or(String::new(), |f| format!("; failed once: {f}"));
        let (program, method) = (lane.contestant.program(), lane.contestant.method());
        let _ = writeln!(
            out,
            "  {program} {method}: {} settings, least error {least:.1e}{failure}",
            lane.tried.len()
        );
    }
    out
}

struct Setting(f64);

impl std::fmt::Display for Setting {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0 >= 1.0 {
            write!(f, "N={:.0}", self.0)
        } else {
            write!(f, "tol={:.0e}", self.0)
        }
    }
}

/// Header of the CSV file.
pub const HEADER: &str = "scene,program,method,target,setting,error,milliseconds,least,most,rounds,ratio_to_quickest_peer\n";

/// Rows of the CSV file for one scene: every contestant at every target it reaches.
pub fn csv(task: &Task, lanes: &[Lane]) -> String {
    let mut out = String::new();
    for &target in task.targets {
        let peer = best_peer(lanes, target).map(|p| p.ms.0);
        for lane in lanes {
            let Some(i) = lane.quickest(target) else {
                continue;
            };
            let tried = &lane.tried[i];
            let (median, low, high) = tried.spread();
            let ratio = peer.map_or(String::new(), |p| format!("{:.4}", 1e3 * median / p));
            let _ = writeln!(
                out,
                "{},{},\"{}\",{target:e},{:e},{:.3e},{:.5},{:.5},{:.5},{},{ratio}",
                task.name,
                lane.contestant.program(),
                lane.contestant.method(),
                tried.setting,
                tried.error,
                1e3 * median,
                1e3 * low,
                1e3 * high,
                tried.seconds.len().saturating_sub(1).max(1)
            );
        }
    }
    out
}

/// One scene as JSON: what was reached, and every setting tried.
pub fn json(task: &Task, lanes: &[Lane]) -> Value {
    let cell = |name: &str, target: f64| {
        best(lanes, name, target).map(|b| {
            let peer = best_peer(lanes, target).map(|p| b.ms.0 / p.ms.0);
            json!({"target": target, "method": b.method, "setting": b.setting, "error": b.error, "milliseconds": b.ms.0,
                "least": b.ms.1, "most": b.ms.2, "rounds": b.rounds, "ratio_to_quickest_peer": peer})
        })
    };
    let reached: Vec<Value> = groups(lanes)
        .iter()
        .map(|name| json!({"program": name, "reached": task.targets.iter().map(|&t| cell(name, t)).collect::<Vec<_>>()}))
        .collect();
    let point = |t: &crate::race::Tried| json!({"setting": t.setting, "error": t.error, "steps": t.steps, "milliseconds": 1e3 * t.median()});
    let curves: Vec<Value> = lanes
        .iter()
        .map(|lane| {
            json!({"program": group(lane), "method": lane.contestant.method(), "failure": lane.failure,
                "points": lane.tried.iter().map(point).collect::<Vec<_>>()})
        })
        .collect();
    let at_tolerance = task.tolerance.map(|tolerance| {
        let rows = lanes.iter().filter_map(|lane| {
            let at = Best::of(lane, lane.at_tolerance(tolerance)?);
            Some(json!({"program": group(lane), "method": at.method, "error": at.error, "milliseconds": at.ms.0,
                "least": at.ms.1, "most": at.ms.2}))
        });
        json!({"tolerance": tolerance, "rows": rows.collect::<Vec<_>>()})
    });
    json!({"scene": task.name, "title": task.title, "end": task.end, "targets": task.targets,
        "reference_within": task.uncertainty, "programs": reached, "curves": curves, "at_tolerance": at_tolerance})
}

/// Header of the table for documents.
pub const MARKDOWN_HEADER: &str = "| scene, errors | equip, closure | equip, by hand | heyoka | quickest other program | closure / quickest |\n\
    |---|---|---|---|---|---|\n";

/// One scene as a row of a table for documents: milliseconds to each target, joined by strokes.
pub fn markdown(task: &Task, lanes: &[Lane]) -> String {
    let joined = |cell: &dyn Fn(f64) -> Option<String>| {
        let cells = task.targets.iter().map(|&t| cell(t));
        let cells: Vec<_> = cells.map(|c| c.unwrap_or("–".into())).collect();
        cells.join(" / ")
    };
    // By either kind of steps.
    let ours = |route: &str, target: f64| {
        let names = groups(lanes);
        let names = names.iter().filter(|n| n.starts_with(route));
        let best = names.filter_map(|n| best(lanes, n, target));
        best.min_by(|a, b| a.ms.0.total_cmp(&b.ms.0))
    };
    let closure = |t: f64| ours("equip closure", t);
    let ms = |best: Best| digits(best.ms.0);
    let peer = |t: f64| best_peer(lanes, t);
    let targets: Vec<String> = task.targets.iter().map(|t| format!("{t:.0e}")).collect();
    format!(
        "| {}, to {} | {} | {} | {} | {} | {} |\n",
        task.title,
        targets.join(" / "),
        joined(&|t| closure(t).map(ms)),
        joined(&|t| ours("equip by hand", t).map(ms)),
        joined(&|t| best(lanes, "heyoka", t).map(ms)),
        joined(&|t| peer(t).map(|b| format!("{} {}", b.program, digits(b.ms.0)))),
        joined(&|t| Some(format!("{:.2}", closure(t)?.ms.0 / peer(t)?.ms.0))),
    )
}

/// Three digits.
fn digits(x: f64) -> String {
    let decimals = (2.0 - x.log10().floor()).clamp(0.0, 4.0) as usize;
    format!("{x:.decimals$}")
}
