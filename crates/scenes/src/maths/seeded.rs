//! Seeded random numbers for initial data, the same on every machine and in every float type.
//!
//! SplitMix64, [Steele, Lea, Flood, OOPSLA 2014, Fig. 16].

use equip_scalar::Float;

/// Numbers n·2⁻³¹ with |n| ≤ 2³¹, exact in every float type.
pub(crate) struct Seeded(u64);

impl Seeded {
    pub(crate) fn new(seed: u64) -> Self {
        Seeded(seed)
    }

    /// The next number in [−1, 1).
    pub(crate) fn signed_unit<T: Float>(&mut self) -> T {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        T::ratio((z >> 32) as i64 - (1 << 31), 1 << 31)
    }
}
