//! The page: the conclusion; long runs and close encounters; for each scene time against error; other
//! programs.

use super::long::{CLOSE, LONG, Long, REVOLUTIONS, figure};
use super::peers::{Peers, section};
use super::results::Results;
use super::tables::{accuracies, growth, runs};
use crate::draw::page;
use crate::draw::svg::escape;
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
            "<h2 id=\"{LONG}\">Long runs with step control</h2>"
        ));
        push(figure(title, &long.regular).html());
        push(growth(
            &long.regular.iter().collect::<Vec<_>>(),
            &long.numbers(),
        ));
    }
    if !long.close.is_empty() {
        let title = "Kepler’s problem with close encounters";
        push(format!("<h2 id=\"{CLOSE}\">Close encounters</h2>"));
        push(figure(title, &long.close).html());
        push(growth(
            &long.close.iter().collect::<Vec<_>>(),
            &[REVOLUTIONS],
        ));
    }
    if !results.is_empty() {
        push(
            "<h2 id=\"time\">Time against error</h2>\n<p>CPU time to an error at the end of a short run. \
             <span class=\"first\">Green</span>: the fastest method. <span class=\"keeps\">Blue</span>: the fastest that conserves the energy by \
             itself. A setting counts if the next finer one has at most this error too.</p>"
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
