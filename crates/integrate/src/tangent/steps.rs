//! [`Steps`]: runs whose steps can be followed by a tangent map.

use equip_scalar::Float;

/// A run whose steps can be followed by a [`TangentMap`](crate::TangentMap).
pub trait Steps<T: Float, E>: sealed::Followed<T, E> {}

impl<T: Float, E, S: sealed::Followed<T, E>> Steps<T, E> for S {}

pub(crate) mod sealed {
    use equip_scalar::Float;
    use equip_solver::Core;

    /// What a tangent map reads of a run.
    pub trait Followed<T: Float, E> {
        /// The solver of its steps.
        fn core(&self) -> &Core<T, E>;
        /// The same, to ask it for the parts of its steps.
        fn core_mut(&mut self) -> &mut Core<T, E>;
        /// The time it has reached.
        fn time_reached(&self) -> T;
    }
}
