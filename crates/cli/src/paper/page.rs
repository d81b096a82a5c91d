//! The page: statements, tables and pictures in one file that needs nothing else.

use super::convergence::{Convergence, Member};
use super::figures::Paper;
use super::orbit::Orbit;
use super::picture::{convergence, energy, residual};
use super::statements::Statement;
use crate::draw::page::{cell, page, table};
use crate::draw::svg::escape;

pub(super) fn document(paper: &Paper) -> String {
    let statement = |s: &Statement| {
        let class = if s.holds { "yes" } else { "no" };
        vec![
            cell("statement", escape(&s.statement)),
            cell("stated", escape(&s.stated)),
            cell("measured", escape(&s.measured)),
            cell(
                "holds",
                format!("<span class=\"{class}\">{}</span>", s.word()),
            ),
        ]
    };
    let method = |method: Member, stages: usize| {
        let name = cell("method", escape(method.name()));
        [name, cell("s", stages.to_string())]
    };
    let error = |row: &Convergence| [&method(row.method, row.stages)[..], &row.cells()].concat();
    let orbit = |orbit: &Orbit| [&method(orbit.method, orbit.stages)[..], &orbit.cells()].concat();
    let statements = table("", paper.statements.iter().map(statement));
    let errors = table("numbers", paper.convergence.iter().map(error));
    let orbits = table("numbers", paper.orbits.iter().map(orbit));
    let body = format!(
        "<h1>The statements of the paper, measured</h1>\n\
         <p>L. Brugnano, F. Iavernaro, D. Trigiante: Energy and quadratic invariants preserving integrators of Gaussian type. AIP Conf. Proc. 1281 \
         (2010) 227–230. By its own method: a Gauss method of s stages with one free parameter α = α<sub>s−1</sub>, for which every step solves \
         g(α, h) = H(y<sub>1</sub>(α, h)) − H(y<sub>0</sub>) = 0. Kepler’s problem, e = 0.6, from the pericentre. equip {version}.</p>\n\
         {statements}\
         <h2>Orders</h2>\n{convergence}<p>Error after two periods, largest component of (q, p), in double-double:</p>\n{errors}\
         <h2>The energy error as a function of α</h2>\n{residual}\
         \
         <h2>1000 periods of 200 steps</h2>\n{energy}{orbits}",
        version = paper.version,
        convergence = convergence(&paper.convergence).html(),
        residual = residual(&paper.residual, &paper.convergence).html(),
        energy = energy(&paper.orbits).html(),
    );
    page("equip paper", &body)
}
