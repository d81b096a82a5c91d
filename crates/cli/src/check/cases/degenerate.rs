//! Starts at rest, energies without curvature or without a derivative, NaN and infinity inside a step, all
//! numbers of stages.

use crate::check::case::{Case, End, Kind, Problem, Reference, Trajectory};
use equip_autodiff::Var;

pub(crate) fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    at_rest(&mut all);
    nothing_to_solve(&mut all);
    kinks(&mut all);
    domains(&mut all);
    every_number_of_stages(&mut all);
    all
}

/// One degree of freedom, p²/2 + U(q), from doubles.
fn particle(name: &'static str, potential: fn(Var) -> Var, q: f64, p: f64) -> Case {
    Case::new(name, move || {
        Problem::recorded(|q, p| 0.5 * p[0] * p[0] + potential(q[0]), &[q], &[p])
    })
}

/// Nothing may move, or no faster than the closed form says.
fn at_rest(all: &mut Vec<Case>) {
    let pendulum = |name, q: &str| {
        let values = [("q", q), ("p", "0")];
        Case::scene(name, "pendulum", &values).against(Reference::Closed)
    };
    all.push(pendulum("pendulum at rest, hanging", "0"));
    all.push(pendulum(
        "pendulum at rest, upright to 1e-16",
        "3.141592653589793",
    ));
    let none = [("energy", "0"), ("q2", "0"), ("p2", "0")];
    let still = Case::scene("Hénon–Heiles at rest", "henon-heiles", &none);
    all.push(
        still
            .trajectory(Trajectory::Within(0.0))
            .against(Reference::fine(6, 2)),
    );
}

/// Quadratic and linear H: every member of the family keeps it.
fn nothing_to_solve(all: &mut Vec<Case>) {
    all.push(particle("harmonic oscillator", |q| 0.5 * q * q, 1.0, 0.0));
    all.push(particle("free fall", |q| q, 1.0, 0.0));
    all.push(particle("free flight", |_| Var::from(0.0), 1.0, 1.0));
}

/// Energies that are not smooth where the motion goes, or where it starts. Steps over a kink of |q| are made
/// in two parts; between two kinks it is quadratic, and every α keeps it.
fn kinks(all: &mut Vec<Case>) {
    let fine = || Reference::fine(6, 8);
    for s in [3, 4, 6] {
        let case = particle("|q|, across the kink", |q| q.abs(), 1.0, 0.0).stages(s);
        all.push(case.steps(200, 0.13).against(fine()));
    }
    let from = particle("|q|, from the kink", |q| q.abs(), 0.0, 1.0);
    all.push(from.steps(200, 0.13));
    let root = particle("√(q²), from q = 0", |q| (q * q).sqrt(), 0.0, 1.0);
    all.push(root.ending(End::Error(
        &[Kind::EnergyNotFinite],
        0.0,
        "the derivative of √(q²) at 0 is 0/0",
    )));
    let across = particle(
        "√(q² + 1e-20), nearly a kink",
        |q| (q * q + 1e-20).sqrt(),
        1.0,
        0.0,
    );
    all.push(across.steps(200, 0.13).against(fine()));
}

/// H is not a number, or infinite, in a part of the plane that the motion or a stage runs into.
fn domains(all: &mut Vec<Case>) {
    const LEAVES: &[Kind] = &[Kind::NotFinite, Kind::NoConvergence];
    // The force draws the particle over the edge q = 1 of the domain, in finite time.
    let edge = particle("√(1 − q), over the edge", |q| (1.0 - q).sqrt(), 0.0, 0.1);
    all.push(edge.steps(200, 0.05).ending(End::Error(
        LEAVES,
        1.6,
        "the motion leaves the domain of H",
    )));
    // The wall at q = 1 keeps the particle in, but stages of large steps look behind it.
    for (p, name) in [
        (1.5, "−ln(1 − q) + q²/2, p=1.5"),
        (4.0, "−ln(1 − q) + q²/2, p=4"),
    ] {
        let wall = particle(name, |q| 0.5 * q * q - (1.0 - q).ln(), 0.0, p);
        let wall = wall.steps(100, 0.1).against(Reference::fine(8, 8));
        all.push(if p < 2.0 {
            wall
        } else {
            wall.trajectory(Trajectory::Open("the bounce is not resolved"))
        });
    }
    // So steep that the stages of a step into it see anything from nothing to overflow.
    let overflow = particle(
        "exp(500 q), a steep wall",
        |q| (500.0 * q).exp(),
        -1.0,
        40.0,
    );
    all.push(
        overflow
            .steps(100, 0.02)
            .ending(End::Either(LEAVES, "the step is too large for the wall")),
    );
    let escape = particle("p²/2 − q⁴, to infinity", |q| -q.powi(4), 1.0, 1.0);
    all.push(escape.steps(1000, 0.01).ending(End::Error(
        &[Kind::Escape],
        0.74,
        "the orbit reaches infinity in finite time",
    )));
    let nothing = particle("a start where H is infinite", |q| 1.0 / q, 0.0, 1.0);
    all.push(nothing.ending(End::Error(&[Kind::EnergyNotFinite], 0.0, "1/q at q = 0")));
}

/// s = 2 … 20.
fn every_number_of_stages(all: &mut Vec<Case>) {
    for s in [2, 3, 4, 5, 6, 8, 10, 12, 16, 20] {
        let case = Case::scene(
            "Hénon–Heiles E=1/12, every s",
            "henon-heiles",
            &[("energy", "1/12")],
        );
        let case = case
            .stages(s)
            .steps(100, 0.5)
            .against(Reference::fine(24, 1));
        // With one α for one constraint there is no choice of the direction.
        all.push(if s == 2 {
            case.known_deficit(4.3)
        } else {
            case
        });
    }
}
