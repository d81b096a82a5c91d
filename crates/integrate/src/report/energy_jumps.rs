//! [`EnergyJumps`]: where the value of H itself jumps.

use equip_scalar::Float;

/// Crossings at which the value of H jumps. No force comes of a jump: the motion continues as if there were
/// none, and H differs by it.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyJumps<T> {
    /// How many there were.
    pub count: u64,
    /// The largest, in the unit of H.
    pub largest: T,
}

impl<T: Float> EnergyJumps<T> {
    /// Those `before`, and one more.
    pub(crate) fn after(before: Option<Self>, jump: T) -> Self {
        let (count, largest) = before.map_or((0, T::int(0)), |jumps| (jumps.count, jumps.largest));
        EnergyJumps {
            count: count + 1,
            largest: largest.max(jump.abs()),
        }
    }
}
