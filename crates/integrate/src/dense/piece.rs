//! The refined polynomial of one step, and its values.

use crate::time::visible;
use equip_scalar::Float;
use equip_solver::{MAX_STAGES, State};
use equip_tableau::legendre_integrals_at;

/// The refined polynomial of one step (or part of a halved one).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece<T> {
    pub(crate) time: T,
    pub(crate) time_low: T,
    pub(crate) h: T,
    pub(super) start: State<T>,
    /// y1, which the polynomial meets but for rounding.
    pub(super) end: Vec<T>,
    /// h γ_k, k < M, one after the other.
    pub(super) coefficients: Vec<T>,
}

impl<T: Float> Piece<T> {
    /// Where in the piece time `t` is: 0 at its start, 1 at its end.
    pub(crate) fn place_of(&self, t: T) -> T {
        let place = ((t - self.time) - self.time_low) / self.h;
        place.max(T::int(0)).min(T::int(1))
    }

    /// The time at `place`.
    pub(crate) fn time_at(&self, place: T) -> T {
        self.time + (self.time_low + place * self.h)
    }

    /// (q, p) of u at `place` into `y`.
    pub(crate) fn state_at(&self, place: T, y: &mut [T]) {
        let (m, n) = (y.len() / 2, self.end.len());
        let is_end = place == T::int(1);
        let mut integrals = [T::int(0); MAX_STAGES];
        let integrals = &mut integrals[..self.coefficients.len() / n];
        if !is_end {
            legendre_integrals_at(place, integrals);
        }
        for (j, y) in y.iter_mut().enumerate() {
            let j = visible::place(j, m, n);
            if is_end {
                *y = self.end[j];
                continue;
            }
            let terms = self.coefficients[j..].iter().step_by(n);
            // From the smallest to the largest.
            let sum = terms.zip(&*integrals).rev();
            let sum = sum.fold(self.start.lo[j], |sum, (&g, &i)| sum + g * i);
            *y = self.start.hi[j] + sum;
        }
    }
}
