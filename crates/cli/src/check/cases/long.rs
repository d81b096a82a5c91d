//! Long runs: the energy error must not grow with the number of steps.

use crate::check::case::{Case, Reference, Trajectory};
use std::f64::consts::TAU;

pub(crate) fn cases() -> Vec<Case> {
    let kepler = |steps: u64| {
        let name = format!("Kepler e=0.6, {} periods", steps / 50);
        Case::scene(name, "kepler", &[("e", "0.6")]).steps(steps, TAU / 50.0)
    };
    let henon_heiles = |steps: u64| {
        let name = format!("Hénon–Heiles E=1/8, t = {}", steps / 4);
        let values = [("energy", "1/8")];
        let case = Case::scene(name, "henon-heiles", &values).steps(steps, 0.25);
        case.trajectory(Trajectory::Open("beyond the predictability horizon"))
    };
    vec![
        kepler(100_000).against(Reference::Closed),
        henon_heiles(100_000),
        henon_heiles(1_000_000).quick(false),
        kepler(10_000_000)
            .against(Reference::Closed)
            .trajectory(Trajectory::Open(
                "too long for a comparison of trajectories: energy and outcomes only",
            ))
            .quick(false),
    ]
}
