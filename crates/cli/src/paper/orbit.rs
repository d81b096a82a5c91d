//! 1000 periods of Kepler's problem, 200 steps each: the energy along them.

use super::convergence::{Member, run};
use crate::fault::Fault;
use equip_scenes::Instance;
use serde::Serialize;

pub(super) const PERIODS: u32 = 1000;
pub(super) const STEPS: u32 = 200;
/// Numbers of stages.
const STAGES: [usize; 2] = [2, 3];

/// One run.
#[derive(Debug, Serialize)]
pub(super) struct Orbit {
    pub(super) stages: usize,
    pub(super) method: Member,
    /// At the end.
    pub(super) error: f64,
    /// Largest |ΔH| and |ΔL|.
    pub(super) energy: f64,
    pub(super) momentum: f64,
    /// Largest |ΔH| of each period.
    pub(super) energies: Vec<f64>,
}

pub(super) fn measure(instance: &Instance) -> Result<Vec<Orbit>, Fault> {
    let mut all = Vec::new();
    for stages in STAGES {
        for method in [Member::Gauss, Member::Solved] {
            let figures = run::<f64>(instance, method.method(stages), STEPS, PERIODS)?;
            all.push(Orbit {
                stages,
                method,
                error: figures.error,
                energy: figures.energy,
                momentum: figures.momentum,
                energies: figures.energies,
            });
        }
    }
    Ok(all)
}
