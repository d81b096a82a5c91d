//! [`EnergyJumps`]: discontinuities of the value of H.

use equip_scalar::Float;

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
