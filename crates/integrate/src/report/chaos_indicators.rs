//! [`ChaosIndicators`]: whether a run is regular or chaotic, in two numbers.

/// What a propagated deviation tells of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ChaosIndicators<T> {
    /// λ(t), per unit of time.
    pub lyapunov: T,
    /// The mean of MEGNO over time.
    pub megno: T,
}
