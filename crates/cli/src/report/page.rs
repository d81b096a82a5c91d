//! The page: facts, and for each scene its picture and tables, in one file that needs nothing else.

use super::accuracy::Time;
use super::measure::Curve;
use super::peers::{Peers, is_ours};
use super::results::{Results, times};
use crate::draw::svg::escape;
use std::fmt::Write;

const STYLE: &str = "
:root { color-scheme: light dark; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 1.5rem auto; max-width: 1420px; padding: 0 1rem; }
h2 { margin-top: 3rem; } svg { max-width: 100%; height: auto; border-radius: 6px; }
table { border-collapse: collapse; white-space: nowrap; font-variant-numeric: tabular-nums; }
.wide { overflow-x: auto; }
th, td { padding: .15rem .8rem; text-align: right; border-bottom: 1px solid #8884; }
th:first-child, td:first-child { text-align: left; }
.first { color: #1a7f37; font-weight: bold; } .keeps { color: #2f7fb8; font-weight: bold; }
nav a { margin-right: 1rem; white-space: nowrap; } small, .note { color: GrayText; }
summary { cursor: pointer; margin: .6rem 0; }
";

/// The page as text.
pub(super) fn page(results: &[Results], facts: &[String], peers: Option<&Peers>) -> String {
    let mut body = String::new();
    let mut push = |text: String| {
        // Writing to a String does not fail.
        let _ = writeln!(body, "{text}");
    };
    push(contents(results, peers));
    for result in results {
        push(format!(
            "<h2 id=\"{0}-{1}\">{2} <small>{1}</small></h2>",
            result.name,
            result.precision,
            escape(&result.title)
        ));
        push(format!(
            "<p class=\"note\">End state: {}.</p>",
            escape(&result.source)
        ));
        push(result.svg.clone());
        push(format!(
            "<h3>Milliseconds to an error of</h3><div class=\"wide\">{}</div>\
             <p class=\"note\"><span class=\"first\">Green</span>: the quickest. <span class=\"keeps\">Blue</span>: the quickest that keeps the \
             energy on its own.</p>",
            accuracies(result)
        ));
        if let Some(advice) = advice(result) {
            push(format!("<p>{}</p>", escape(&advice)));
        }
        push(format!(
            "<details><summary>All runs</summary><div class=\"wide\">{}</div></details>",
            runs(result)
        ));
        for curve in &result.curves {
            if let Some(failure) = &curve.failure {
                push(format!(
                    "<p class=\"note\">{}, some settings: {}</p>",
                    escape(&curve.contender.name()),
                    escape(failure)
                ));
            }
        }
    }
    if let Some(peers) = peers {
        push("<h1>Compared with other integrators</h1>".into());
        push(format!(
            "<p>CPU milliseconds on {}; the rules are in docs/compare.md. In brackets: our time over that of the quickest other program. \
             Least and most of the rounds show when the pointer rests on a figure.</p>",
            escape(&peers.cpu)
        ));
        push(format!(
            "<p class=\"note\">{}</p>",
            escape(&versions(peers))
        ));
        for scene in &peers.scenes {
            push(format!(
                "<h2 id=\"peers-{}\">{}</h2>",
                escape(&scene.scene),
                escape(&scene.title)
            ));
            push(scene.picture());
            push(format!("<div class=\"wide\">{}</div>", against(scene)));
            if let Some(at) = &scene.at_tolerance {
                push(format!(
                    "<h3>All at tolerance {:.0e}</h3><div class=\"wide\">{}</div>",
                    at.tolerance,
                    at_tolerance(at)
                ));
            }
        }
    }
    let facts: String = facts
        .iter()
        .map(|f| format!("<li>{}</li>", escape(f)))
        .collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>equip report</title>\n<style>{STYLE}</style>\n<h1>Error against run time</h1>\n<ul>{facts}</ul>\n{body}</html>\n"
    )
}

/// The quickest method that keeps the energy on its own, for an error in the middle of those looked at, or
/// for the smallest above it that one reaches.
fn advice(result: &Results) -> Option<String> {
    let middle = (result.targets.len() / 2).min(result.targets.len().checked_sub(1)?);
    let keeping = || result.curves.iter().filter(|c| c.contender.keeps_energy());
    let quickest = |k: usize| {
        let timed = keeping().filter_map(|curve| {
            let milliseconds = times(curve, result.targets).get(k)?.milliseconds()?;
            Some((milliseconds, curve.contender.name()))
        });
        timed.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let found = (0..=middle)
        .rev()
        .find_map(|k| Some((result.targets[k], quickest(k)?)));
    let (target, (milliseconds, name)) = found?;
    Some(format!(
        "To begin with: {name}, the quickest that keeps the energy on its own for an error of {target:e} ({} ms).",
        brief(milliseconds)
    ))
}

/// A table of heads and rows of cells that are escaped already.
fn table(heads: &[String], rows: &[Vec<String>]) -> String {
    let heads: String = heads.iter().map(|h| format!("<th>{h}</th>")).collect();
    let row = |cells: &Vec<String>| {
        let cells: String = cells.iter().map(|c| format!("<td>{c}</td>")).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let rows: String = rows.iter().map(row).collect();
    format!("<table><thead><tr>{heads}</tr></thead><tbody>\n{rows}</tbody></table>")
}

/// Three digits, or nothing.
fn brief(x: f64) -> String {
    match x {
        x if !x.is_finite() => String::new(),
        x if (0.1..1e4).contains(&x) => {
            let decimals = (2.0 - x.log10().floor()).clamp(0.0, 3.0) as usize;
            format!("{x:.decimals$}")
        }
        x => format!("{x:.2e}"),
    }
}

/// Links to all scenes.
fn contents(results: &[Results], peers: Option<&Peers>) -> String {
    let link = |id: String, title: String| format!("<a href=\"#{id}\">{title}</a> ");
    let scenes = results.iter().map(|r| {
        let id = format!("{}-{}", r.name, r.precision);
        link(id.clone(), id)
    });
    let others = peers.iter().flat_map(|p| &p.scenes).map(|scene| {
        let name = escape(&scene.scene);
        link(
            format!("peers-{name}"),
            format!("{name} and other programs"),
        )
    });
    let links: String = scenes.chain(others).collect();
    format!("<nav>{links}</nav>")
}

fn versions(peers: &Peers) -> String {
    let all = peers.versions.iter();
    let known =
        all.filter_map(|(program, version)| Some(format!("{program} {}", version.as_ref()?)));
    known.collect::<Vec<_>>().join(", ")
}

fn accuracies(result: &Results) -> String {
    let mut heads = vec!["method".to_owned()];
    heads.extend(result.targets.iter().map(|t| format!("{t:.0e}")));
    let all: Vec<(&Curve, Vec<Time>)> = result
        .curves
        .iter()
        .map(|c| (c, times(c, result.targets)))
        .collect();
    let quickest = |k: usize, which: fn(&Curve) -> bool| {
        let chosen = all.iter().filter(|(curve, _)| which(curve));
        let column = chosen.filter_map(|(_, times)| times[k].milliseconds());
        column.fold(f64::INFINITY, f64::min)
    };
    let cell = |k: usize, time: &Time| {
        let text = match time {
            Time::NotReached => return "–".to_owned(),
            Time::AtMost(ms) => format!("≤ {}", brief(*ms)),
            Time::Interpolated(ms) => brief(*ms),
        };
        let ms = time.milliseconds();
        if ms == Some(quickest(k, |_| true)) {
            format!("<span class=\"first\">{text}</span>")
        } else if ms == Some(quickest(k, |c| c.contender.keeps_energy())) {
            format!("<span class=\"keeps\">{text}</span>")
        } else {
            text
        }
    };
    let rows: Vec<Vec<String>> = all
        .iter()
        .map(|(curve, times)| {
            let mut cells = vec![escape(&curve.contender.name())];
            cells.extend(times.iter().enumerate().map(|(k, time)| cell(k, time)));
            cells
        })
        .collect();
    table(&heads, &rows)
}

fn runs(result: &Results) -> String {
    let mut heads: Vec<String> = [
        "method",
        "order",
        "setting",
        "steps",
        "error",
        "energy defect",
    ]
    .map(Into::into)
    .into();
    heads.extend(result.invariants.iter().map(|name| escape(name)));
    heads.extend(
        [
            "gradients",
            "per step",
            "iterations per step",
            "ms, median",
            "least",
            "most",
            "repeats",
        ]
        .map(Into::into),
    );
    let per_step = |count: u64, steps: u64| format!("{:.1}", count as f64 / steps.max(1) as f64);
    let row = |curve: &Curve, point: &super::measure::Point| {
        let o = &point.outcome;
        let setting = if curve.contender.adapts() {
            format!("tolerance {:.0e}", point.setting)
        } else {
            format!("{} steps", point.setting)
        };
        let mut cells = vec![
            escape(&curve.contender.name()),
            curve.contender.order().to_string(),
            setting,
            o.steps.to_string(),
            format!("{:.1e}", o.error),
            format!("{:.1e}", o.energy),
        ];
        cells.extend(o.invariants.iter().map(|x| format!("{x:.1e}")));
        let (least, most) = point.spread();
        cells.extend([
            o.gradients.to_string(),
            per_step(o.gradients, o.steps),
            per_step(o.iterations, o.steps),
            brief(point.median()),
            brief(least),
            brief(most),
            point.milliseconds.len().to_string(),
        ]);
        cells
    };
    let rows: Vec<_> = result
        .curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(move |point| row(curve, point)))
        .collect();
    table(&heads, &rows)
}

fn against(scene: &super::peers::Scene) -> String {
    let mut heads = vec!["program".to_owned()];
    heads.extend(scene.targets.iter().map(|t| format!("{t:.0e}")));
    let rows: Vec<Vec<String>> = scene
        .programs
        .iter()
        .map(|program| {
            let mut cells = vec![escape(&program.program)];
            cells.extend(program.reached.iter().map(|reached| match reached {
                None => "–".into(),
                Some(r) => {
                    let ours = is_ours(&program.program);
                    let ratio = r.ratio_to_quickest_peer.filter(|_| ours);
                    let ratio = ratio.map_or(String::new(), |x| format!(" ({x:.2})"));
                    let spread = format!("{} to {}", brief(r.least), brief(r.most));
                    format!(
                        "<span title=\"{spread}\">{}{ratio}</span> <small>{}</small>",
                        brief(r.milliseconds),
                        escape(&r.method)
                    )
                }
            }));
            cells
        })
        .collect();
    table(&heads, &rows)
}

fn at_tolerance(at: &super::peers::AtTolerance) -> String {
    let heads = ["program", "method", "ms", "least", "most", "error"].map(Into::into);
    let row = |row: &super::peers::Row| {
        vec![
            escape(&row.program),
            escape(&row.method),
            brief(row.milliseconds),
            brief(row.least),
            brief(row.most),
            row.error.map_or("–".into(), |e| format!("{e:.1e}")),
        ]
    };
    table(&heads, &at.rows.iter().map(row).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::{Curve, Results, advice, brief};
    use crate::report::contender::{Contender, Outcome};
    use crate::report::measure::Point;

    /// Two methods that keep the energy: to 1e-8 the second is the quicker, and none reaches 1e-10.
    #[test]
    fn the_advice_is_for_an_error_that_is_reached() {
        let curve = |stages, reached: &[(f64, f64)]| Curve {
            contender: Contender::Equip(stages),
            points: (reached.iter())
                .map(|&(error, milliseconds)| Point {
                    setting: 1.0,
                    outcome: Outcome {
                        error,
                        ..Outcome::default()
                    },
                    milliseconds: vec![milliseconds],
                })
                .collect(),
            failure: None,
        };
        let mut results = Results {
            name: "",
            precision: "f64",
            title: String::new(),
            source: String::new(),
            invariants: vec![],
            targets: &[1e-6, 1e-8, 1e-10, 1e-12],
            curves: vec![
                curve(4, &[(1e-7, 1.0), (1e-9, 16.0)]),
                curve(8, &[(1e-7, 2.0), (1e-9, 3.0)]),
            ],
            svg: String::new(),
        };
        let text = advice(&results).unwrap();
        assert!(text.contains("EQUIP(8)") && text.contains("1e-8"), "{text}");
        results.curves.clear();
        assert_eq!(advice(&results), None);
    }

    #[test]
    fn three_digits() {
        let texts = [0.012345, 0.12345, 1.2345, 123.45, 12345.0, f64::NAN].map(brief);
        assert_eq!(texts, ["1.23e-2", "0.123", "1.23", "123", "1.23e4", ""]);
    }
}
