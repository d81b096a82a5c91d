//! The fixed grid of time, the run on it, and output between its points.

use crate::error::IntegrateError;
use equip_scalar::Float;

/// The grid t0 + n h over an interval.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid<T> {
    t0: T,
    t1: T,
    h: T,
    pub(crate) whole: u64,
    rest: bool,
}

impl<T: Float> Grid<T> {
    pub(crate) fn new(t0: T, t1: T, h: T) -> Result<Self, IntegrateError<T>> {
        if !(h > T::int(0)) || !h.is_finite() {
            return Err(IntegrateError::StepNotPositive { step: h });
        }
        if !(t1 >= t0) || !t0.is_finite() || !t1.is_finite() {
            return Err(IntegrateError::Interval { start: t0, end: t1 });
        }
        let ratio = (t1 - t0) / h;
        // The step count must be exact in an f64 and fit the time grid of T.
        if !(ratio.to_f64() < 9e15) {
            return Err(IntegrateError::TooManySteps {
                steps: ratio.to_f64(),
            });
        }
        let largest = t0.abs().max(t1.abs());
        if ratio > T::int(0) && largest + h == largest {
            return Err(IntegrateError::StepBelowTimeResolution {
                step: h,
                time: largest,
            });
        }
        // h divides the interval if the rounded number of steps meets t1 within the rounding of the time.
        let nearest = ratio.round();
        let miss = (t0 + nearest * h - t1).abs();
        let divides = miss <= T::int(2) * T::EPSILON * largest.max(t1 - t0);
        let whole = if divides { nearest } else { ratio.floor() };
        Ok(Grid {
            t0,
            t1,
            h,
            whole: whole.to_f64() as u64,
            rest: !divides,
        })
    }

    pub(crate) fn steps(&self) -> u64 {
        self.whole + u64::from(self.rest)
    }

    pub(crate) fn time(&self, index: u64) -> T {
        if index > self.whole {
            self.t1
        } else {
            self.t0 + T::int(index as i64) * self.h
        }
    }

    pub(crate) fn size(&self, index: u64) -> T {
        if index > self.whole {
            self.t1 - self.time(self.whole)
        } else {
            self.h
        }
    }
}
