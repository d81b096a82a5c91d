//! [`Steps`]: runs whose steps can be followed by a tangent map.

use crate::error::IntegrateError;
use equip_scalar::Float;

/// A run whose steps can be followed by a [`TangentMap`](crate::TangentMap).
pub trait Steps<T: Float>: sealed::Followed<T> {
    /// Makes the next step towards the time `t`, forward or back, but not beyond it: repeated while it
    /// returns
    /// `true`, it makes the steps of the run's own `advance_to`, and the caller may stop between two of them.
    ///
    /// # Errors
    /// A time that is not finite, and a step that cannot be made.
    fn advance_towards(&mut self, t: T) -> Result<bool, IntegrateError<T>> {
        self.step_to(t)
    }
}

impl<T: Float, S: sealed::Followed<T>> Steps<T> for S {}

pub(crate) mod sealed {
    use crate::error::IntegrateError;
    use equip_scalar::Float;
    use equip_solver::{Core, Part};

    /// What a tangent map reads of a run.
    pub trait Followed<T: Float> {
        /// The solver of its steps.
        fn core(&self) -> &Core<T>;
        /// The same, to ask it for the parts of its steps.
        fn core_mut(&mut self) -> &mut Core<T>;
        /// What the step made last has passed through, part by part.
        fn parts_made(&self) -> &[Part<T>];
        /// The time it has reached.
        fn time_reached(&self) -> T;
        /// How many steps it has made.
        fn steps_made(&self) -> u64;
        /// Makes the next step towards `t`, but not beyond it. Returns whether there was one to make.
        ///
        /// # Errors
        /// A time that is not finite, and a step that cannot be made.
        fn step_to(&mut self, t: T) -> Result<bool, IntegrateError<T>>;
    }
}
