//! [`EnergyFloor`]: what rounding alone makes of the energy, beside the energies themselves.

use crate::control::policy::MOST_FLOOR;
use equip_scalar::Float;

/// The largest round-off floor of the energy over the steps that kept it, and what it is to be held against.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EnergyFloor<T> {
    /// The floor, in the unit of H. Of a quadratic H, which nothing solves for, |H − H_ref|.
    pub floor: T,
    /// |H_ref|; where the floor is beyond 1e-6 of that, the largest kinetic energy ½ |Σ p_i ∂H/∂p_i| seen
    /// since, if it is larger.
    pub scale: T,
}

impl<T: Float> EnergyFloor<T> {
    /// Of a run that begins where H is `h_ref`.
    pub(crate) fn new(h_ref: T) -> Self {
        EnergyFloor {
            floor: T::int(0),
            scale: h_ref.abs(),
        }
    }

    /// Whether a defect within the floor says that the energy was kept: the floor is at most 1e-6 of the
    /// scale. At rest where H = 0 there is nothing to lose.
    pub fn is_small(&self) -> bool {
        let is_rest = self.scale == T::int(0) && self.floor.is_finite();
        is_rest || self.floor <= self.scale * T::ratio(1, MOST_FLOOR)
    }

    /// A step ended with this `floor`. The `kinetic` energy there is asked for only if it matters.
    pub(crate) fn see(&mut self, floor: T, kinetic: impl FnOnce() -> T) {
        // Once NaN, always.
        if !(floor <= self.floor) && self.floor.is_finite() {
            self.floor = floor;
        }
        let is_beyond = !(self.floor <= self.scale * T::ratio(1, MOST_FLOOR));
        if is_beyond {
            self.scale = self.scale.max(kinetic());
        }
    }
}

/// ½ |Σ p_i ∂H/∂p_i| over the first `m` momenta of y = (q, p), from ∇H there.
pub(crate) fn kinetic_energy<T: Float>(y: &[T], gradient: &[T], m: usize) -> T {
    let half = y.len() / 2;
    let terms = y[half..][..m].iter().zip(&gradient[half..][..m]);
    let sum = terms.fold(T::int(0), |sum, (&p, &v)| sum + p * v);
    sum.abs() / T::int(2)
}
