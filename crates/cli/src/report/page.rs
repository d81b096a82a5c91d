//! The page: the conclusion; long runs and close encounters; for each scene time against error; other
//! programs.

use super::accuracy::Time;
use super::long::{CLOSE, LONG, Long, REVOLUTIONS, figure};
use super::measure::{Curve, Point};
use super::peers::{Peers, section};
use super::results::{Results, times};
use crate::commands::growth;
use crate::draw::page::{self, cell, table};
use crate::draw::svg::escape;
use crate::text::three_digits;
use std::fmt::Write;

/// The page as text.
pub(super) fn page(
    (conclusion, facts): (&[String], &[String]),
    long: &Long,
    results: &[Results],
    peers: Option<&Peers>,
) -> String {
    let mut body = String::new();
    let mut push = |text: String| {
        // Writing to a String does not fail.
        let _ = writeln!(body, "{text}");
    };
    push("<h1>EQUIP and Gauss: error, energy and time</h1>".into());
    let sentences: String = conclusion
        .iter()
        .map(|s| format!("<li>{}</li>\n", escape(s)))
        .collect();
    push(format!("<ol class=\"conclusion\">\n{sentences}</ol>"));
    push(contents(long, results, peers));
    if !long.regular.is_empty() {
        let title = "Kepler’s problem over many revolutions";
        push(format!(
            "<h2 id=\"{LONG}\">Long runs with step size control</h2>"
        ));
        push(figure(title, &long.regular).html());
        push(growth_table(&long.regular, &long.numbers()));
    }
    if !long.close.is_empty() {
        let title = "Kepler’s problem with close encounters";
        push(format!("<h2 id=\"{CLOSE}\">Close encounters</h2>"));
        push(figure(title, &long.close).html());
        push(growth_table(&long.close, &[REVOLUTIONS]));
    }
    if !results.is_empty() {
        push(
            "<h2 id=\"time\">Time against error</h2>\n<p>CPU time to an error at the end of a short run. \
             <span class=\"first\">Green</span>: the fastest method. <span class=\"keeps\">Blue</span>: the fastest that conserves the energy by \
             construction. A setting reaches an error only if the next finer setting reaches it too.</p>"
                .into(),
        );
    }
    for result in results {
        push(format!("<a id=\"{}\"></a>", result.id()));
        push(result.figure.html());
        push(format!(
            "<p>CPU milliseconds to an error. End state: {}.</p>\n{}",
            escape(&result.source),
            accuracies(result)
        ));
        push(format!(
            "<details><summary>All runs</summary>{}</details>",
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
        push(section(peers));
    }
    let facts: String = facts
        .iter()
        .map(|f| format!("<li>{}</li>", escape(f)))
        .collect();
    push(format!("<h2>How it was measured</h2>\n<ul>{facts}</ul>"));
    page::page("equip report", &body)
}

/// Links to all parts.
fn contents(long: &Long, results: &[Results], peers: Option<&Peers>) -> String {
    let link = |id: &str, title: &str| format!("<a href=\"#{id}\">{}</a> ", escape(title));
    let mut links = Vec::new();
    if !long.regular.is_empty() {
        links.push(link(LONG, "Long runs"));
    }
    if !long.close.is_empty() {
        links.push(link(CLOSE, "Close encounters"));
    }
    links.extend(results.iter().map(|r| link(&r.id(), &r.title)));
    if peers.is_some() {
        links.push(link("peers", "Other programs"));
    }
    format!("<nav>{}</nav>", links.concat())
}

/// Uncorrected steps: Gauss corrects none, which is no news.
fn uncorrected(is_equip: bool, count: u64) -> String {
    if is_equip {
        count.to_string()
    } else {
        "–".into()
    }
}

/// Runs with step control: errors after the `numbers` of revolutions.
fn growth_table(curves: &[growth::Curve], numbers: &[u64]) -> String {
    let row = |curve: &growth::Curve| {
        let c = &curve.certificate;
        let per_revolution = |x: f64| x / curve.revolutions;
        let energy = curve.energies.last().copied().unwrap_or(f64::NAN);
        let levels = c.energy_in_round_off_levels;
        let levels = levels.map_or("–".into(), |x| format!("{x:.1}"));
        let steps = per_revolution(c.counts.steps as f64);
        let uncorrected = uncorrected(curve.is_equip, c.counts.uncorrected());
        let time = three_digits(per_revolution(curve.milliseconds));
        let mut cells = vec![
            cell("method", format!("{}(8)", curve.name())),
            cell("e", escape(&curve.eccentricity)),
            cell("tolerance", escape(&curve.tolerance)),
        ];
        cells.extend(numbers.iter().map(|&n| {
            let error = format!("{:.1e}", curve.error_after(n));
            (format!("error after {n}").into(), error)
        }));
        cells.extend([
            cell("max |ΔH/H₀|", format!("{energy:.1e}")),
            cell("in round-off levels", levels),
            cell("steps per revolution", format!("{steps:.1}")),
            cell("uncorrected steps", uncorrected),
            cell("CPU ms per revolution", time),
        ]);
        cells
    };
    table("numbers", curves.iter().map(row))
}

/// Milliseconds to each error.
fn accuracies(result: &Results) -> String {
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
    let text = |k: usize, time: &Time| {
        let text = match time {
            Time::NotReached => return "–".to_owned(),
            Time::AtMost(ms) => format!("≤ {}", three_digits(*ms)),
            Time::Interpolated(ms) => three_digits(*ms),
        };
        let ms = time.milliseconds();
        if ms == Some(quickest(k, |_| true)) {
            format!("<span class=\"first\">{text}</span>")
        } else if ms == Some(quickest(k, |c| c.contender.is_equip)) {
            format!("<span class=\"keeps\">{text}</span>")
        } else {
            text
        }
    };
    let rows = all.iter().map(|(curve, times)| {
        let mut cells = vec![cell("method", escape(&curve.contender.name()))];
        let columns = result.targets.iter().zip(times).enumerate();
        cells.extend(columns.map(|(k, (t, time))| (format!("{t:.0e}").into(), text(k, time))));
        cells
    });
    table("numbers", rows)
}

/// All runs of a scene.
fn runs(result: &Results) -> String {
    let row = |(curve, point): (&Curve, &Point)| {
        let (o, contender) = (&point.outcome, &curve.contender);
        let setting = match contender.adapts {
            true => format!("tolerance {:.0e}", point.setting),
            false => format!("{} steps", point.setting),
        };
        let uncorrected = uncorrected(contender.is_equip, o.uncorrected);
        let per_step = |count: u64| format!("{:.1}", count as f64 / o.steps.max(1) as f64);
        let (least, most) = point.spread();
        let mut cells = vec![
            cell("method", escape(&contender.name())),
            cell("order", contender.order().to_string()),
            cell("setting", setting),
            cell("steps", o.steps.to_string()),
            cell("uncorrected", uncorrected),
            cell("error", format!("{:.1e}", o.error)),
            cell("max |ΔH|", format!("{:.1e}", o.energy)),
        ];
        let invariants = result.invariants.iter().zip(&o.invariants);
        cells.extend(invariants.map(|(name, x)| (escape(name).into(), format!("{x:.1e}"))));
        cells.extend([
            cell("∇H", o.gradients.to_string()),
            cell("∇H per step", per_step(o.gradients)),
            cell("iterations per step", per_step(o.iterations)),
            cell("ms, median", three_digits(point.median())),
            cell("least", three_digits(least)),
            cell("most", three_digits(most)),
            cell("repeats", point.milliseconds.len().to_string()),
        ]);
        cells
    };
    let curves = result.curves.iter();
    let points = curves.flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
    table("numbers", points.map(row))
}
