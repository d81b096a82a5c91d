//! [`PhasePerStep`]: whether the steps resolve the motion.

use equip_scalar::Float;

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
