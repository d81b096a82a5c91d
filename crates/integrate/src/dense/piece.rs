//! The polynomial of one step and its values; refined unless its stages do not converge.

use crate::dense::polynomial::Polynomial;
use crate::time::visible;
use equip_scalar::Float;
use equip_solver::{Part, State};
use equip_tableau::Coefficients;

/// The polynomial of one step, or of a part of a halved step.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piece<T> {
    pub(crate) time: T,
    pub(crate) time_low: T,
    pub(crate) h: T,
    /// The refined polynomial, or the polynomial of the stages of the step.
    pub(super) polynomial: Polynomial<T>,
    /// y1, where the polynomial ends up to rounding.
    pub(super) end: Vec<T>,
}

impl<T: Float> Piece<T> {
    /// The piece of a part of a step that ends at `end`, with the h γ_k in `coefficients`, one row for each
    /// stage. The linear term is set such that the polynomial ends at y1.
    pub(super) fn new(
        part: &Part<T>,
        time_low: T,
        mut coefficients: Vec<T>,
        end: &State<T>,
    ) -> Self {
        let start = &part.start;
        for (j, out) in coefficients[..start.hi.len()].iter_mut().enumerate() {
            *out = (end.hi[j] - start.hi[j]) + (end.lo[j] - start.lo[j]);
        }
        Piece {
            time: part.time,
            time_low,
            h: part.h,
            polynomial: Polynomial {
                start: start.clone(),
                coefficients,
            },
            end: end.hi.clone(),
        }
    }

    /// The constant polynomial `y` from this time on.
    pub(crate) fn at_rest(y: &State<T>, time: T) -> Self {
        Piece {
            time,
            time_low: T::int(0),
            h: T::int(1),
            polynomial: Polynomial {
                start: y.clone(),
                coefficients: vec![T::int(0); y.hi.len()],
            },
            end: y.hi.clone(),
        }
    }

    /// The polynomial of the stages of the part, of order s.
    pub(crate) fn of_stages(
        method: &Coefficients<T>,
        part: &Part<T>,
        time_low: T,
        end: &State<T>,
    ) -> Self {
        let n = part.start.hi.len();
        let mut coefficients = vec![T::int(0); part.l.len()];
        for (k, out) in (coefficients.chunks_exact_mut(n).enumerate()).take(method.degree()) {
            for (&p, l) in method.legendre(k).iter().zip(part.l.chunks_exact(n)) {
                out.iter_mut().zip(l).for_each(|(sum, &l)| *sum += p * l);
            }
        }
        Self::new(part, time_low, coefficients, end)
    }

    /// The position of time `t` in the piece: 0 at its start, 1 at its end.
    pub(crate) fn place_of(&self, t: T) -> T {
        let place = ((t - self.time) - self.time_low) / self.h;
        place.max(T::int(0)).min(T::int(1))
    }

    /// The time at `place`.
    pub(crate) fn time_at(&self, place: T) -> T {
        self.time + (self.time_low + place * self.h)
    }

    /// Writes (q, p) of u at `place` to `y`.
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
