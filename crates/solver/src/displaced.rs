//! Whether α's that were moved by [`crate::slopes`] have moved the end point too far, where others would find better ones.
//!
//! Slopes know what α's do to the energy and not what they do to the end point. Of many components that are resolved alike that makes no
//! difference; where a few are much faster than the rest, energy at its floor can cost thousands of local errors. So the move is held against what
//! the step is off anyway, as the decay of its Legendre coefficients tells ([`crate::decay`]), and against rounding:
//!
//! $$ \lVert \Delta y_1 \rVert_g \le m\, \varrho^{2s} \max_j \lVert \varphi_j \rVert_g + 16\, \varepsilon f\, \lVert y_1 \rVert_g, \qquad g \in \{q, p\}, $$
//!
//! in Euclidean norms of positions and momenta, m being what the step allows and f the defect in round-off floors: least displacement makes 3 to 9 ε of each.
//! Moves by up to 64 local errors are allowed as well where that is less than 4096 ε ‖y_1‖: near round-off energy needs them, and halves cost three steps.
//!
//! Cost: some passes over the end point, in steps whose α's move.

use crate::decay::decay;
use crate::slopes::Slopes;
use crate::state::State;
use equip_scalar::Float;

/// ε that the end point may be moved by for each floor of the defect.
const FLOORS: i64 = 16;
/// ε that it may be moved by in any case, if that is no more than so many local errors.
const LITTLE: i64 = 4096;
const LITTLE_ERRORS: f64 = 64.0;

#[derive(Debug)]
pub(crate) struct Displaced<T: Float> {
    s: usize,
    /// The end point before the move, and after that the move.
    end: Vec<T>,
    /// What is allowed of positions and momenta.
    most: [T; 2],
}

impl<T: Float> Displaced<T> {
    pub(crate) fn new(s: usize, n: usize) -> Self {
        Displaced {
            s,
            end: vec![T::int(0); n],
            most: [T::int(0); 2],
        }
    }

    /// The α's of a step that ends at `end` without have just been moved along these slopes, for a defect of so many `floors`. So many local errors
    /// are allowed.
    pub(crate) fn begin(
        &mut self,
        slopes: &Slopes<T>,
        end: &State<T>,
        (floors, most_errors): (T, f64),
    ) {
        let sizes = norms(&end.hi);
        // Less motion than this is rounding.
        let least = T::EPSILON.sqrt();
        let motion = [0, 1].map(|g| {
            let norms = slopes.norms[g].iter().take(self.s);
            norms.fold(least * sizes[g], |a, &norm| a.max(norm))
        });
        let error = decay(&slopes.norms, motion, self.s).powi(2 * self.s as i32);
        let rounding = T::EPSILON * T::int(FLOORS) * floors;
        for g in 0..2 {
            let error = T::exact(error) * motion[g];
            let little =
                (T::exact(LITTLE_ERRORS) * error).min(T::EPSILON * T::int(LITTLE) * sizes[g]);
            let most = T::exact(most_errors) * error + rounding * sizes[g];
            self.most[g] = most.max(little);
        }
        self.end.copy_from_slice(&end.hi);
    }

    /// Whether that has moved the end point too far, to `end`.
    pub(crate) fn is_too_far(&mut self, end: &State<T>) -> bool {
        for (moved, &x) in self.end.iter_mut().zip(&end.hi) {
            *moved = x - *moved;
        }
        let moved = norms(&self.end);
        (0..2).any(|g| moved[g] > self.most[g])
    }
}

/// Euclidean norms of positions and momenta.
fn norms<T: Float>(y: &[T]) -> [T; 2] {
    let (q, p) = y.split_at(y.len() / 2);
    [q, p].map(|x| {
        // Side by side.
        let mut squares = [T::int(0); 8];
        for row in x.chunks(8) {
            for (square, &x) in squares.iter_mut().zip(row) {
                *square += x * x;
            }
        }
        squares.iter().fold(T::int(0), |sum, &x| sum + x).sqrt()
    })
}
