//! Many degrees of freedom.

use crate::check::case::{Case, Reference, Trajectory};

/// Degrees of freedom of the largest systems that Newton's method may have to solve.
const AFFORDABLE: usize = 40;

pub(crate) fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    for m in [1, 2, 5, 10, 20, AFFORDABLE] {
        let n = m.to_string();
        let name = format!("FPUT chain, m={m}");
        let row = Case::scene(name, "fput-beta", &[("n", &n)]);
        let row = row.stages(if m > 10 { 3 } else { 4 }).steps(50, 0.2);
        let row = row.against(fine());
        all.push(if m == 2 { row.known_deficit(11.0) } else { row });
    }
    for m in [8, 16, AFFORDABLE] {
        let n = m.to_string();
        for (modulation, reference) in [("0", Reference::Closed), ("0.1", fine())] {
            let name = format!("dnls, m={m}, modulation {modulation}");
            let row = Case::scene(name, "dnls", &[("n", &n), ("modulation", modulation)]);
            let row = row.stages(if m > 8 { 3 } else { 4 }).steps(50, 0.2);
            all.push(row.against(reference));
        }
        let name = format!("sine-Gordon, m={m}");
        let row = Case::scene(name, "sine-gordon", &[("n", &n)]);
        let row = row
            .stages(if m > 8 { 3 } else { 4 })
            .steps(50, 10.0 / m as f64);
        all.push(row.against(fine()));
    }
    all.extend(many());
    for row in &mut all {
        if matches!(row.reference, Reference::None) {
            row.expect.trajectory =
                Trajectory::Open("too stiff for a reference: energy and outcomes only");
        }
    }
    all
}

/// Many components, α_k along slopes: resolved, too long for fixed-point iteration at the whole step, with
/// stiff springs, and with springs too stiff for halves.
fn many() -> Vec<Case> {
    let row = |name: &str, scene_name: &'static str, values: &[(&'static str, &str)]| {
        Case::scene(name, scene_name, values)
    };
    let springs = |omega: &'static str, h_omega: f64| {
        let name = format!("fpu, 16 springs of ω={omega}");
        let omega_number: f64 = omega.parse().unwrap_or(f64::NAN);
        row(&name, "fpu", &[("m", "16"), ("omega", omega)])
            .omega(omega_number)
            .steps(50, h_omega / omega_number)
    };
    vec![
        row("sine-Gordon, m=128", "sine-gordon", &[("n", "128")])
            .stages(6)
            .steps(50, 0.5)
            .against(fine()),
        row(
            "sine-Gordon, m=128, long steps",
            "sine-gordon",
            &[("n", "128")],
        )
        .stages(8)
        .steps(25, 2.0)
        .against(fine()),
        row(
            "Lennard-Jones, n=19",
            "lennard-jones",
            &[("n", "19"), ("speed", "1")],
        )
        .stages(6)
        .steps(50, 0.05)
        .against(fine()),
        row(
            "FPUT chain, m=1000",
            "fput-beta",
            &[("n", "1000"), ("amplitude", "400")],
        )
        .stages(4)
        .steps(50, 1.0)
        .against(fine()),
        springs("50", 5.0)
            .stages(12)
            .against(Reference::fine(16, 2)),
        springs("500", 50.0).quick(false),
    ]
}

fn fine() -> Reference {
    Reference::fine(6, 2)
}
