//! The refined polynomial of one step, and its values.

use crate::dense::polynomial::Polynomial;
use crate::time::visible;
use equip_scalar::Float;

/// The refined polynomial of one step (or part of a halved one).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece<T> {
    pub(crate) time: T,
    pub(crate) time_low: T,
    pub(crate) h: T,
    /// Of M stages.
    pub(super) polynomial: Polynomial<T>,
    /// y1, which the polynomial meets but for rounding.
    pub(super) end: Vec<T>,
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
        if place == T::int(1) {
            for (j, y) in y.iter_mut().enumerate() {
                *y = self.end[visible::place(j, m, n)];
            }
            return;
        }
        let integrals = self.polynomial.integrals(place);
        for (j, y) in y.iter_mut().enumerate() {
            let j = visible::place(j, m, n);
            *y = self.polynomial.component(j, &integrals);
        }
    }
}
