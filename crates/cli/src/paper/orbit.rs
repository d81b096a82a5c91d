//! 1000 periods of Kepler's problem, 200 steps each: the energy along them.

use super::convergence::{Figures, Member, run};
use crate::draw::page::{Cell, cell};
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
    #[serde(flatten)]
    pub(super) figures: Figures,
}

impl Orbit {
    /// Errors over the last period, of the energy and of the angular momentum, as the tables have them.
    pub(super) fn cells(&self) -> [Cell; 3] {
        let Figures {
            last_period,
            energy,
            momentum,
            ..
        } = &self.figures;
        [
            cell("error, last period", format!("{last_period:.2e}")),
            cell("max |ΔH|", format!("{energy:.1e}")),
            cell("max |ΔL|", format!("{momentum:.1e}")),
        ]
    }
}

pub(super) fn measure(instance: &Instance) -> Result<Vec<Orbit>, Fault> {
    let mut all = Vec::new();
    for stages in STAGES {
        for method in [Member::Gauss, Member::Solved] {
            let figures = run::<f64>(instance, method.method(stages), STEPS, PERIODS)?;
            all.push(Orbit {
                stages,
                method,
                figures,
            });
        }
    }
    Ok(all)
}
