//! Fast oscillations around slow motion, from resolved (hω = 0.1) to 80 of them in a step (hω = 500).
//!
//! Resolved rows (hω ≤ 3) are judged by the whole state, the others by their slow variables.

use crate::check::case::{Case, End, Judged, Kind, Reference, Trajectory};

const TOO_LARGE: &str = "so many oscillations in a step that the stage equations may have no solution that follows the motion";
/// Largest hω at which an oscillation counts as resolved.
const RESOLVED: f64 = 3.0;

pub(crate) fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    fpu(&mut all);
    spring_pendulum(&mut all);
    double_pendulum(&mut all);
    all
}

/// What is judged of a row with this hω, `slow` being what is slow.
fn judged(case: Case, slow: Judged) -> Case {
    if case.omega.unwrap_or(0.0) * case.h <= RESOLVED {
        case
    } else {
        case.judging(slow).trajectory(Trajectory::Slow)
    }
}

/// Gauss with so many stages and steps `grid / divide`, for all rows with this `key`.
fn shared(key: String, grid: f64, divide: u64, stages: usize, end: f64) -> Reference {
    Reference::Shared {
        key,
        grid,
        divide,
        stages,
        end,
    }
}

/// Three stiff springs; ω = 50 and 500 until t = 10, ω = 5000 until t = 2.
fn fpu(all: &mut Vec<Case>) {
    let shared =
        |omega: &str, grid, divide, end| shared(format!("fpu {omega}"), grid, divide, 7, end);
    let case = |omega: &str, s: usize, h: f64, end: f64| {
        let name = format!("fpu ω={omega}");
        let case = Case::scene(name, "fpu", &[("omega", omega)])
            .stages(s)
            .omega(omega.parse().unwrap_or(0.0))
            .steps((end / h).round() as u64, h);
        judged(case, Judged::First(3))
    };
    for s in [3, 4, 6] {
        for h in [0.01, 0.02, 0.05, 0.1, 0.25, 1.0] {
            let row = case("50", s, h, 10.0).against(shared("50", 0.01, 1, 10.0));
            all.push(row);
        }
        for h in [0.002, 0.005, 0.01, 0.02, 0.1, 0.25, 1.0] {
            let row = case("500", s, h, 10.0).against(shared("500", 0.001, 1, 10.0));
            all.push(row.quick(s == 4 && h > 0.01));
        }
        for h in [0.001, 0.01, 0.02, 0.1] {
            let row = case("5000", s, h, 2.0).against(shared("5000", 0.001, 5, 2.0));
            all.push(row.quick(false));
        }
    }
    // hω = 0.1; Gauss with more stages is the reference.
    for (omega, h) in [("50", 2e-3), ("500", 2e-4), ("5000", 2e-5)] {
        let fine = Reference::fine(6, 1);
        all.push(case(omega, 4, h, 500.0 * h).against(fine));
    }
    let far = case("50", 4, 10.0, 200.0).ending(End::Either(&[Kind::Astray], TOO_LARGE));
    all.push(far.trajectory(Trajectory::Open(
        "the slow motion is not resolved either: no comparison of trajectories",
    )));
}

/// A point on a spring of stiffness k, ω = √k.
fn spring_pendulum(all: &mut Vec<Case>) {
    type Family = (&'static str, f64, f64, u64, &'static [f64]);
    let families: [Family; 3] = [
        ("1e4", 5.0, 0.005, 1, &[0.005, 0.02, 0.1, 0.2, 0.5, 1.0]),
        ("1e6", 5.0, 0.002, 2, &[0.002, 0.01, 0.02, 0.05, 0.1, 0.5]),
        ("1e8", 2.0, 0.002, 20, &[0.002, 0.01, 0.05]),
    ];
    for (k, end, grid, divide, sizes) in families {
        for s in [3, 4, 6] {
            for &h in sizes {
                let name = format!("spring pendulum k={k}");
                let k_value: f64 = k.parse().unwrap_or(0.0);
                let case = Case::scene(name, "spring-pendulum", &[("k", k)])
                    .stages(s)
                    .omega(k_value.sqrt())
                    .steps((end / h).round() as u64, h)
                    .against(shared(format!("spring pendulum {k}"), grid, divide, 8, end));
                let case = judged(case, Judged::Polar);
                all.push(case.quick(k != "1e8" || s == 4));
            }
        }
    }
}

/// Not separable; fast frequency near 2.2 C.
fn double_pendulum(all: &mut Vec<Case>) {
    for (c, finest, coarsest) in [("32", 7, 3), ("1024", 9, 5)] {
        for s in [3, 4, 6] {
            for power in (coarsest..=finest).rev().step_by(2) {
                let h = 0.5_f64.powi(power);
                let name = format!("stiff double pendulum C={c}");
                let c_value: f64 = c.parse().unwrap_or(0.0);
                let case = Case::scene(name, "stiff-double-pendulum", &[("c", c)])
                    .stages(s)
                    .omega(2.2 * c_value)
                    .steps((2.0 / h).round() as u64, h)
                    .against(shared(
                        format!("double pendulum {c}"),
                        0.5_f64.powi(9),
                        4,
                        8,
                        2.0,
                    ));
                let case = judged(case, Judged::First(1));
                let case = match (c, s, power) {
                    ("32", 6, 7) => case.known_deficit(4.4),
                    ("32", 6, 5) => case.known_deficit(3.9),
                    ("1024", 6, 9) => case.known_deficit(3.5),
                    _ => case,
                };
                all.push(if s == 6 && h * c_value > 2.0 {
                    case.ending(End::Either(&[Kind::Astray], TOO_LARGE))
                } else {
                    case
                });
            }
        }
    }
}
