//! Entries of the certificate: indicators of chaos, jumps of H, the phase per step, and the sizes of variable
//! steps.

use equip_scalar::Float;

/// Indicators of chaos from a propagated tangent vector.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ChaosIndicators<T> {
    /// λ(t), per unit of time.
    pub lyapunov: T,
    /// The time average of MEGNO.
    pub megno: T,
}

/// Crossings at which the value of H jumps. A jump causes no force: the motion continues as without a jump,
/// and H changes by the jump.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyJumps<T> {
    /// The number of jumps.
    pub count: u64,
    /// The largest jump, in the unit of H.
    pub largest: T,
}

impl<T: Float> EnergyJumps<T> {
    /// Adds one jump.
    pub(crate) fn after(before: Option<Self>, jump: T) -> Self {
        let (count, largest) = before.map_or((0, T::int(0)), |jumps| (jumps.count, jumps.largest));
        EnergyJumps {
            count: count + 1,
            largest: largest.max(jump.abs()),
        }
    }
}

/// The largest hω of the fastest motion, ω being the largest |eigenvalue| of J∇²H.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PhasePerStep<T> {
    /// hω: the phase of the fastest oscillation per step, in radians.
    pub angle: f64,
    /// The size of that step, without sign.
    pub step: T,
}

impl<T: Float> PhasePerStep<T> {
    /// The phase with the larger angle.
    pub(crate) fn max(self, other: Option<Self>) -> Self {
        other.filter(|o| o.angle >= self.angle).unwrap_or(self)
    }

    /// The step size with half the admissible hω. Its phase error is at most 2e-3.
    pub(crate) fn resolving_step(&self, stages: usize) -> f64 {
        self.step.to_f64() * (0.5 * stages as f64 / self.angle)
    }

    /// Whether steps of a method with s `stages` resolve the motion: hω ≤ s.
    pub fn is_resolved(&self, stages: usize) -> bool {
        self.angle <= stages as f64
    }
}

/// Statistics of step control.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct VariableSteps<T> {
    /// The requested tolerance.
    pub tolerance: T,
    /// The smallest accepted step. A step shortened to meet the end of the run does not count.
    pub smallest: T,
    /// The largest accepted step.
    pub largest: T,
    /// The number of steps rejected because of their error estimate.
    pub rejected: u64,
    /// The number of attempts that failed because their stages or an admissible α were not found.
    pub failed: u64,
}

impl<T: Float> VariableSteps<T> {
    /// For a run that begins.
    pub(crate) fn new(tolerance: T) -> Self {
        VariableSteps {
            tolerance,
            smallest: T::INFINITY,
            largest: T::int(0),
            rejected: 0,
            failed: 0,
        }
    }

    /// Sizes of zero if there is no step.
    pub(crate) fn of_steps(self) -> Self {
        VariableSteps {
            smallest: self.smallest.min(self.largest),
            ..self
        }
    }
}
