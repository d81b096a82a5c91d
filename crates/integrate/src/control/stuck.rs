//! Why no step above the smallest size could be made.
//!
//! Whether a singularity is near is told by how much the force or the speed, the largest component of ∂H/∂q
//! or of ∂H/∂p, has grown since the run began; whether it is that of a motion which runs away to infinity, by
//! [`escapes`], as with fixed steps.
//!
//! Cost: four gradients, after a run has come to its end.

use crate::control::escape::escapes;
use crate::control::policy::{GROWN, ROUNDING};
use crate::error::IntegrateError;
use equip_autodiff::Evaluator;
use equip_scalar::Float;

/// A step that is too small to be made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TooSmall<T> {
    /// Time at its start.
    pub(crate) time: T,
    /// Its size, with its sign.
    pub(crate) h: T,
    /// Smallest step, and tolerance, as they were given.
    pub(crate) min: T,
    pub(crate) tolerance: T,
}

impl<T: Float> TooSmall<T> {
    /// The error of a run that came from the state `start` and stands at `y`. `cause` is why the last step
    /// tried was not found, if it was not.
    pub(crate) fn error(
        self,
        energy: &mut Evaluator<T>,
        (start, y): (&[T], &[T]),
        cause: Option<IntegrateError<T>>,
    ) -> IntegrateError<T> {
        let (time, step) = (self.time, self.h);
        let growth = growth(energy, start, y);
        let has_grown = growth >= T::int(GROWN);
        if has_grown && let Some(size) = escapes(energy, y, self.h * T::int(GROWN)) {
            return IntegrateError::Escape { time, step, size };
        }
        cause.unwrap_or(IntegrateError::StepBelowMinimum {
            time,
            step: step.abs(),
            min: self.min,
            tolerance: self.tolerance,
            growth: if has_grown { growth } else { T::int(0) },
        })
    }
}

/// How many times as large the force or the speed is at `y` as it is at `start`, whichever has grown more.
fn growth<T: Float>(energy: &mut Evaluator<T>, start: &[T], y: &[T]) -> T {
    let m = y.len() / 2;
    let mut sizes = |y: &[T]| {
        let mut f = vec![T::int(0); y.len()];
        energy.vector_field(y, &mut f);
        let largest = |half: &[T]| half.iter().fold(T::int(0), |most, x| most.max(x.abs()));
        [largest(&f[..m]), largest(&f[m..])]
    };
    let (first, now) = (sizes(start), sizes(y));
    let ratios = first.into_iter().zip(now);
    ratios
        .filter(|&(first, _)| first > T::int(0))
        .fold(T::int(0), |most, (first, now)| most.max(now / first))
}

/// The shortest step that time resolves.
pub(crate) fn shortest_at<T: Float>(time: T) -> T {
    T::int(ROUNDING) * T::EPSILON * time.abs()
}
