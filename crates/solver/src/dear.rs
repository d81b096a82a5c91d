//! Defects that are dear to remove: a circular orbit has the least energy of all with its angular momentum, and one floor more than that is an
//! eccentricity of √ε.
//!
//! Where a response takes the end point further than [`FAR`] times what a defect is worth, the defect is left, as long as it is within the floors
//! that are promised. That is remembered, so that the next steps need not find out by a response each; and forgotten by degrees.

use crate::newton::ENERGY_STAGNATED;
use equip_scalar::Float;

/// Measured on circular orbits, where the slope is all rounding: 1.7e3 to 8e6; with e = 0.1 to 0.9 less than 512.
const FAR: i64 = 1 << 10;
/// The most that is remembered of it.
const MOST: i64 = 1 << 25;
/// Defects of the step with α = 0 up to this many floors are left to later steps in any case if slopes do not remove them: to remove less by more is
/// to move by rounding.
const AT_FLOOR: i64 = 4;

#[derive(Debug)]
pub(crate) struct Dear<T> {
    /// How far the end point would have had to move for a defect that was left for it, over what that is worth.
    pub(crate) far: T,
}

impl<T: Float> Dear<T> {
    pub(crate) fn new() -> Self {
        Dear { far: T::int(0) }
    }

    /// Whether a defect of the step with α = 0 is left without asking.
    pub(crate) fn leaves(&self, floors: T) -> bool {
        let is_dear = self.far > T::int(FAR);
        floors <= T::int(if is_dear { ENERGY_STAGNATED } else { AT_FLOOR })
    }

    /// A defect of so many floors was left.
    pub(crate) fn has_left(&mut self, floors: T) {
        if floors > T::int(AT_FLOOR) {
            self.far *= T::ratio(127, 128);
        }
    }

    /// A defect of so many floors would take the end point so `far`. Returns whether it is left for that.
    pub(crate) fn is_too_far(&mut self, floors: T, far: T) -> bool {
        let is_left = floors <= T::int(ENERGY_STAGNATED) && far > T::int(FAR);
        if is_left {
            self.far = far.min(T::int(MOST));
        }
        is_left
    }
}
