//! The memory of step control, and a propagated tangent vector, in a checkpoint.

use crate::checkpoints::exact::Exact;
use crate::error::IntegrateError;
use crate::events::switch_memory::SwitchMemory;
use crate::report::energy_round_off::EnergyRoundOff;
use crate::report::variable_steps::VariableSteps;
use equip_scalar::Float;

/// The memory of step control.
#[derive(Debug, Clone, PartialEq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub(crate) struct ControlMemory {
    pub(crate) next: Exact,
    pub(crate) tries: Option<u32>,
    pub(crate) smallest: Exact,
    pub(crate) largest: Exact,
    pub(crate) rejected: u64,
    pub(crate) failed: u64,
    pub(crate) switches: SwitchMemory,
}

/// A tangent vector, and the sums of its growth.
#[derive(Debug, Clone, PartialEq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub(crate) struct ChaosMemory {
    pub(crate) elapsed: Exact,
    pub(crate) sums: [Exact; 3],
    pub(crate) deviation: Vec<Exact>,
}

impl ControlMemory {
    /// From the steps so far, the proposed size of the next step with the number of attempts so far, and the
    /// memory of the switches.
    pub(crate) fn of<T: Float>(
        steps: &VariableSteps<T>,
        (next, tries): (Exact, Option<u32>),
        switches: SwitchMemory,
    ) -> Self {
        ControlMemory {
            next,
            tries,
            smallest: Exact::of(steps.smallest),
            largest: Exact::of(steps.largest),
            rejected: steps.rejected,
            failed: steps.failed,
            switches,
        }
    }

    /// The statistics of the steps so far.
    pub(crate) fn variable_steps<T: Float>(
        &self,
        tolerance: T,
    ) -> Result<VariableSteps<T>, IntegrateError<T>> {
        Ok(VariableSteps {
            tolerance,
            smallest: self.smallest.read()?,
            largest: self.largest.read()?,
            rejected: self.rejected,
            failed: self.failed,
        })
    }
}

/// The round-off level of the energy as numbers.
pub(crate) fn round_off_memory<T: Float>(of: EnergyRoundOff<T>) -> [Exact; 6] {
    let underflows = T::int(i64::from(of.underflows));
    [
        of.round_off,
        of.time,
        of.scale,
        of.last,
        of.recent_kinetic,
        underflows,
    ]
    .map(Exact::of)
}

/// The round-off level of the energy from these numbers.
pub(crate) fn read_round_off<T: Float>(
    from: &[Exact; 6],
) -> Result<EnergyRoundOff<T>, IntegrateError<T>> {
    let [round_off, time, scale, last, recent_kinetic, underflows] = from;
    Ok(EnergyRoundOff {
        round_off: round_off.read()?,
        time: time.read()?,
        scale: scale.read()?,
        last: last.read()?,
        recent_kinetic: recent_kinetic.read()?,
        underflows: underflows.read::<T>()? != T::int(0),
    })
}
