//! `equip paper`: the statements of the paper, by its own method, held against measured figures.
//!
//! L. Brugnano, F. Iavernaro, D. Trigiante, *Energy and quadratic invariants preserving integrators of
//! Gaussian type*, AIP Conf. Proc. 1281 (2010) 227–230; arXiv:1005.1930. The method has one free parameter
//! α = α_{s−1}, and every step solves g(α, h) = H(y1(α, h)) − H(y0) = 0, however far α moves the end of the
//! step. The problem is Kepler's, e = 0.6, from the pericentre.

mod convergence;
mod figures;
mod orbit;
mod page;
mod picture;
mod residual;
mod statements;

use crate::args::PaperArgs;
use crate::fault::Fault;
use crate::text::Print;
use crate::write::outputs::{Output, apart, printed};
use figures::Paper;
use statements::{Statement, statements};
use std::fmt::Write as _;
use std::io::Write as _;

pub(crate) fn paper(args: &PaperArgs) -> Result<(), Fault> {
    apart(&[
        ("--json", args.json.as_deref()),
        ("--html", args.html.as_deref()),
        printed(),
    ])?;
    let json = args.json.as_deref().map(Output::open).transpose()?;
    let html = args.html.as_deref().map(Output::open).transpose()?;
    let instance = equip_scenes::find("kepler")?.instance(&[("e", "0.6")])?;
    let convergence = convergence::measure(&instance)?;
    let residual = residual::measure(&instance)?;
    let orbits = orbit::measure(&instance)?;
    let statements = statements(&convergence, &residual, &orbits);
    let paper = Paper {
        version: env!("CARGO_PKG_VERSION"),
        statements,
        convergence,
        residual,
        orbits,
    };
    let mut out = Print::default();
    write!(out, "{}", text(&paper))?;
    if let Some(file) = json {
        let text = serde_json::to_string_pretty(&paper).map_err(std::io::Error::from)?;
        file.write(&format!("{text}\n"))?;
    }
    if let Some(file) = html {
        file.write(&page::document(&paper))?;
    }
    let rows = paper.statements.len();
    match paper.statements.iter().filter(|s| !s.holds).count() {
        0 => Ok(out.end()?),
        failed => Err(Fault::Statements { failed, rows }),
    }
}

/// The table on the terminal.
fn text(paper: &Paper) -> String {
    let width = |of: fn(&Statement) -> &str| {
        let lengths = paper.statements.iter().map(|s| of(s).chars().count());
        lengths.max().unwrap_or(0)
    };
    let (first, second, third) = (
        width(|s| &s.statement),
        width(|s| &s.stated),
        width(|s| &s.measured),
    );
    let mut text = String::new();
    // Writing to a String does not fail.
    let mut line = |cells: [&str; 4]| {
        let [a, b, c, d] = cells;
        let _ = writeln!(text, "{a:<first$}  {b:<second$}  {c:<third$}  {d}");
    };
    line(["statement", "stated", "measured", "holds"]);
    for s in &paper.statements {
        line([&s.statement, &s.stated, &s.measured, s.word()]);
    }
    text += "\nError after two periods, largest component of (q, p), in double-double\n";
    text += "s  method               80 steps        160        320   order\n";
    for row in &paper.convergence {
        let (s, method) = (row.stages, row.method.name());
        let [a, b, c, order] = row.cells().map(|(_, figure)| figure);
        let _ = writeln!(text, "{s:<3}{method:<18}{a:>11}{b:>11}{c:>11}{order:>8}");
    }
    text += "\nKepler's problem, 1000 periods of 200 steps\n";
    text += "s  method                    error     max |ΔH|     max |ΔL|\n";
    for orbit in &paper.orbits {
        let (s, method) = (orbit.stages, orbit.method.name());
        let [a, b, c] = orbit.cells().map(|(_, figure)| figure);
        let _ = writeln!(text, "{s:<3}{method:<18}{a:>13}{b:>13}{c:>13}");
    }
    text
}
