//! The fixed grid of time.

use crate::error::IntegrateError;
use equip_scalar::Float;

/// The grid t0 + n h up to the end of a run; h has either sign.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Grid<T> {
    t0: T,
    t1: T,
    h: T,
    /// The index of the last point of the grid, and whether a shorter step follows.
    whole: i64,
    rest: bool,
}

/// Whether two times are equal up to the rounding of a grid that begins at `start`.
pub(super) fn is_same_time<T: Float>(a: T, b: T, start: T) -> bool {
    let largest = start.abs().max(b.abs()).max((b - start).abs());
    (a - b).abs() <= T::int(2) * T::EPSILON * largest
}

impl<T: Float> Grid<T> {
    pub(crate) fn new(t0: T, t1: T, h: T) -> Result<Self, IntegrateError<T>> {
        let ratio = (t1 - t0) / h;
        // The number of steps must be exact in `f64` and fit the time grid of T.
        if !(ratio.abs().to_f64() < 9e15) {
            return Err(IntegrateError::TooManySteps {
                steps: ratio.abs().to_f64(),
            });
        }
        let largest = t0.abs().max(t1.abs());
        if ratio > T::int(0) && largest + h.abs() == largest {
            return Err(IntegrateError::StepBelowTimeResolution {
                step: h,
                time: largest,
            });
        }
        // h divides the interval if the rounded number of steps meets t1 up to the rounding of time.
        let nearest = ratio.round();
        let divides = is_same_time(t0 + nearest * h, t1, t0);
        let whole = if divides { nearest } else { ratio.floor() };
        Ok(Grid {
            t0,
            t1,
            h,
            whole: whole.to_f64() as i64,
            rest: !divides,
        })
    }

    /// The end of the grid.
    pub(crate) fn end(&self) -> T {
        self.t1
    }

    /// The index of the end.
    pub(crate) fn last(&self) -> i64 {
        self.whole + i64::from(self.rest)
    }

    /// The time at `place`; the last one is the end of the run to the last bit.
    pub(crate) fn time(&self, place: i64) -> T {
        if place >= self.last() {
            self.t1
        } else {
            self.t0 + T::int(place) * self.h
        }
    }

    /// The signed size of the step that ends at `place`.
    pub(crate) fn size(&self, place: i64) -> T {
        if place > self.whole {
            self.t1 - self.time(self.whole)
        } else {
            self.h
        }
    }
}
