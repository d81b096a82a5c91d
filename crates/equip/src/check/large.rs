//! Many degrees of freedom.

use super::case::{Case, Reference, Trajectory, scene};

const THEME: &str = "large";
/// Degrees of freedom of the largest systems: the linear algebra is dense, and a step costs (2 s m)³.
const AFFORDABLE: usize = 40;

pub(crate) fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    for m in [1, 2, 5, 10, 20, AFFORDABLE] {
        let n = m.to_string();
        let name = format!("FPUT chain, m={m}");
        let row = Case::new(THEME, name, scene("fput-beta", &[("n", &n)]));
        let row = row.stages(if m > 10 { 3 } else { 4 }).steps(50, 0.2);
        all.push(if m > 20 {
            row.complete_only()
        } else {
            row.against(fine())
        });
    }
    for m in [8, 16, AFFORDABLE] {
        let n = m.to_string();
        for (modulation, reference) in [("0", Reference::Closed), ("0.1", fine())] {
            let name = format!("dnls, m={m}, modulation {modulation}");
            let row = Case::new(
                THEME,
                name,
                scene("dnls", &[("n", &n), ("modulation", modulation)]),
            );
            let row = row.stages(if m > 8 { 3 } else { 4 }).steps(50, 0.2);
            all.push(if m <= 16 {
                row.against(reference)
            } else {
                row.complete_only()
            });
        }
        let name = format!("sine-Gordon, m={m}");
        let row = Case::new(THEME, name, scene("sine-gordon", &[("n", &n)]));
        let row = row
            .stages(if m > 8 { 3 } else { 4 })
            .steps(50, 10.0 / m as f64);
        all.push(if m <= 16 {
            row.against(fine())
        } else {
            row.complete_only()
        });
    }
    for row in &mut all {
        if matches!(row.reference, Reference::None) {
            row.expect.trajectory =
                Trajectory::Open("too large for a reference: energy and outcomes");
        }
    }
    all
}

fn fine() -> Reference {
    Reference::Fine {
        stages: 6,
        divide: 2,
    }
}
