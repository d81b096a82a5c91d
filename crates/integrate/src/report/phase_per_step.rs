//! [`PhasePerStep`]: whether steps resolve the motion.

use equip_scalar::Float;

/// hω of the fastest motion, the largest eigenvalue of J∇²H, where it was largest.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PhasePerStep<T> {
    /// hω: the angle by which the fastest oscillation turns in a step, in radians.
    pub angle: f64,
    /// Size of that step, without a sign.
    pub step: T,
}

impl<T: Float> PhasePerStep<T> {
    /// The larger of the two.
    pub(crate) fn max(self, other: Option<Self>) -> Self {
        other.filter(|o| o.angle >= self.angle).unwrap_or(self)
    }

    /// The step with half of the hω allowed, which turns that motion by the right angle to 2e-3 or better.
    pub(crate) fn resolving_step(&self, stages: usize) -> f64 {
        self.step.to_f64() * (0.5 * stages as f64 / self.angle)
    }

    /// Whether steps of a method with s `stages` resolve that motion: hω ≤ s.
    pub fn is_resolved(&self, stages: usize) -> bool {
        self.angle <= stages as f64
    }
}
