//! Why no step above the smallest size is possible.
//!
//! A singularity is near if the force or the speed, the largest component of ∂H/∂q or of ∂H/∂p, has grown by
//! a large factor since the run began. As with fixed steps, [`escapes`] decides whether the motion runs away
//! to infinity.
//!
//! Cost: at most three gradients, at the end of a run.

use crate::control::escape::escapes;
use crate::control::policy::{GROWN, ROUNDING};
use crate::error::IntegrateError;
use equip_autodiff::Evaluator;
use equip_scalar::Float;

/// A step below the smallest size.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TooSmall<T> {
    /// The time at its start.
    pub(crate) time: T,
    /// Its signed size.
    pub(crate) h: T,
    /// The smallest step and the tolerance of the options.
    pub(crate) min: T,
    pub(crate) tolerance: T,
}

impl<T: Float> TooSmall<T> {
    /// The error of a run that began at the state `start` and has reached `y`. `cause` is the failure of the
    /// last attempt, if it failed.
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

/// The growth of the force or of the speed from `start` to `y`, whichever is larger.
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
