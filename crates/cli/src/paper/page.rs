//! The page: statements, tables and pictures in one file that needs nothing else.

use super::figures::Paper;
use super::picture::{convergence, energy, residual, roots};
use crate::draw::svg::escape;

const STYLE: &str = "
:root { color-scheme: light dark; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 1.5rem auto; max-width: 1100px; padding: 0 1rem; }
h2 { margin-top: 2.5rem; } svg { max-width: 100%; height: auto; border-radius: 6px; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .8rem; text-align: left; border-bottom: 1px solid #8884; }
.numbers td:nth-child(n+3), .numbers th:nth-child(n+3) { text-align: right; }
.yes { color: #1a7f37; font-weight: bold; } .no { color: #d1242f; font-weight: bold; }
.note { color: GrayText; }
";

pub(super) fn page(paper: &Paper) -> String {
    let statements = paper.statements.iter().map(|s| {
        let class = if s.holds { "yes" } else { "no" };
        let cells = [&s.statement, &s.stated, &s.measured].map(|text| escape(text));
        let [statement, stated, measured] = cells;
        format!(
            "<tr><td>{statement}</td><td>{stated}</td><td>{measured}</td><td class=\"{class}\">{}</td></tr>\n",
            s.word()
        )
    });
    let errors = paper.convergence.iter().map(|row| {
        let [a, b, c] = row.errors.map(|error| format!("{error:.3e}"));
        format!(
            "<tr><td>{}</td><td>{}</td><td>{a}</td><td>{b}</td><td>{c}</td><td>{:.2}</td></tr>\n",
            row.stages,
            escape(row.method.name()),
            row.order()
        )
    });
    let orbits = paper.orbits.iter().map(|orbit| {
        format!(
            "<tr><td>{}</td><td>{}</td><td>{:.2e}</td><td>{:.1e}</td><td>{:.1e}</td></tr>\n",
            orbit.stages,
            escape(orbit.method.name()),
            orbit.error,
            orbit.energy,
            orbit.momentum
        )
    });
    let table = |class: &str, heads: &[&str], rows: String| {
        let heads: String = heads.iter().map(|h| format!("<th>{h}</th>")).collect();
        format!(
            "<table class=\"{class}\"><thead><tr>{heads}</tr></thead><tbody>\n{rows}</tbody></table>\n"
        )
    };
    let statements = table(
        "",
        &["statement", "stated", "measured", "holds"],
        statements.collect(),
    );
    let errors = table(
        "numbers",
        &["s", "method", "80 steps a period", "160", "320", "order"],
        errors.collect(),
    );
    let orbits = table(
        "numbers",
        &["s", "method", "error at the end", "max |ΔH|", "max |ΔL|"],
        orbits.collect(),
    );
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>equip paper</title>\n<style>{STYLE}</style>\n\
         <h1>The paper’s statements, measured</h1>\n\
         <p>L. Brugnano, F. Iavernaro, D. Trigiante: Energy and quadratic invariants preserving integrators of Gaussian type. AIP Conf. Proc. 1281 \
         (2010) 227–230. By its own method: a Gauss method of s stages with one free parameter α = α<sub>s−1</sub>, for which every step solves \
         g(α, h) = H(y<sub>1</sub>(α, h)) − H(y<sub>0</sub>) = 0. Kepler’s problem, e = 0.6, from the pericentre. equip {version}.</p>\n\
         {statements}\
         <h2>Orders</h2>\n{convergence}<p>Error after two periods, largest component of (q, p), in double-double:</p>\n{errors}\
         <h2>The energy error over α</h2>\n{residual}\
         <p class=\"note\">Divided by h³: the curves then have nearly the same derivative at α = 0.</p>\n{roots}\
         <h2>1000 periods of 200 steps</h2>\n{energy}{orbits}</html>\n",
        version = paper.version,
        convergence = convergence(&paper.convergence),
        residual = residual(&paper.residual),
        roots = roots(&paper.residual, &paper.convergence),
        energy = energy(&paper.orbits),
    )
}
