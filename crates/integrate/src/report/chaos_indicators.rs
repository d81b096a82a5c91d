//! [`ChaosIndicators`]: two numbers that distinguish regular from chaotic motion.

/// Indicators of chaos from a propagated tangent vector.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ChaosIndicators<T> {
    /// λ(t), per unit of time.
    pub lyapunov: T,
    /// The time average of MEGNO.
    pub megno: T,
}
