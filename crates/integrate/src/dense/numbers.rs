//! A [`Trajectory`] as a list of numbers, and back.
//!
//! | numbers | content |
//! |---|---|
//! | 4 | m, components n of a state as it is integrated, number of pieces, end |
//! | | for each piece: time, its rounding remainder, h, coefficients per component; y0, its rounding remainder, coefficients, y1 |

use crate::dense::piece::Piece;
use crate::dense::polynomial::Polynomial;
use crate::dense::trajectory::Trajectory;
use crate::time::direction::TimeDirection;
use equip_scalar::Float;
use equip_solver::{MAX_STAGES, State};

/// The length of the head of the list, and of each piece.
const HEAD: usize = 4;

impl<T: Float> Trajectory<T> {
    /// The trajectory as numbers, for [`from_numbers`](Self::from_numbers).
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::{Equip, Trajectory};
    ///
    /// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
    /// let options = Equip::stages(6).step(0.5).dense();
    /// let run = options.integrate(&pendulum, &[1.0], &[0.5], 0.0..=10.0)?;
    /// let trajectory = run.trajectory().ok_or("no trajectory")?;
    /// let again = Trajectory::from_numbers(&trajectory.to_numbers()).ok_or("damaged")?;
    /// assert_eq!(*trajectory, again);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_numbers(&self) -> Vec<T> {
        let count = |n: usize| T::int(n as i64);
        let n = self.pieces.first().map_or(2 * self.m, |p| p.end.len());
        let mut numbers = vec![count(self.m), count(n), count(self.pieces.len()), self.end];
        for piece in &self.pieces {
            let Polynomial {
                start,
                coefficients,
            } = &piece.polynomial;
            let terms = count(coefficients.len() / n);
            numbers.extend([piece.time, piece.time_low, piece.h, terms]);
            for part in [&start.hi, &start.lo, coefficients, &piece.end] {
                numbers.extend_from_slice(part);
            }
        }
        numbers
    }

    /// The trajectory with these [`to_numbers`](Self::to_numbers); `None` if there is none.
    pub fn from_numbers(numbers: &[T]) -> Option<Self> {
        if !numbers.iter().all(|x| x.is_finite()) {
            return None;
        }
        let (head, mut rest) = numbers.split_first_chunk::<HEAD>()?;
        let [m, n, count] = [head[0], head[1], head[2]].map(whole);
        let (m, n, count, end) = (m?, n?, count?, head[3]);
        // If H depends on time, time and its momentum are components as well.
        if m == 0 || (n != 2 * m && n != 2 * m + 2) {
            return None;
        }
        let mut pieces: Vec<Piece<T>> = Vec::new();
        for _ in 0..count {
            let (head, tail) = rest.split_first_chunk::<HEAD>()?;
            let terms = whole(head[3]).filter(|terms| (1..=MAX_STAGES).contains(terms))?;
            rest = tail;
            let mut take = |count: usize| {
                let (part, tail) = rest.split_at_checked(count)?;
                rest = tail;
                Some(part.to_vec())
            };
            pieces.push(Piece {
                time: head[0],
                time_low: head[1],
                h: head[2],
                polynomial: Polynomial {
                    start: State {
                        hi: take(n)?,
                        lo: take(n)?,
                    },
                    coefficients: take(terms * n)?,
                },
                end: take(n)?,
            });
        }
        let is_whole = rest.is_empty() && are_in_order(&pieces, end);
        is_whole.then_some(Trajectory { m, pieces, end })
    }
}

/// A number as a count.
fn whole<T: Float>(x: T) -> Option<usize> {
    let x = x.to_f64();
    (x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0).then_some(x as usize)
}

/// Whether all pieces have the same direction in time, up to the end.
fn are_in_order<T: Float>(pieces: &[Piece<T>], end: T) -> bool {
    let Some(first) = pieces.first() else {
        return true;
    };
    let way = TimeDirection::between(first.time, end).unwrap_or_default();
    let ends = pieces.iter().skip(1).map(|piece| piece.time);
    let mut pairs = pieces.iter().zip(ends.chain([end]));
    pairs.all(|(piece, next)| {
        piece.h != T::int(0) && (piece.time == next || way.is_before(piece.time, next))
    })
}
