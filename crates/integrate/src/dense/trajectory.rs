//! [`Trajectory`]: the state of a run at any time.

use crate::dense::piece::Piece;
use crate::time::direction::TimeDirection;
use equip_scalar::Float;

/// The trajectory of a run between its start and its end, with the accuracy of its steps. Runs with dense
/// output ([`Integrator::dense`](crate::Integrator::dense)) store it.
///
/// Memory: min(2s, 32) + 2 numbers per component and step.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory<T> {
    pub(super) m: usize,
    pub(super) pieces: Vec<Piece<T>>,
    pub(super) end: T,
}

impl<T: Float> Trajectory<T> {
    pub(crate) fn new(m: usize, start: T) -> Self {
        Trajectory {
            m,
            pieces: Vec::new(),
            end: start,
        }
    }

    pub(crate) fn add(&mut self, piece: Piece<T>) {
        self.end = piece.time_at(T::int(1));
        self.pieces.push(piece);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    pub(crate) fn end_at(&mut self, time: T) {
        self.end = time;
    }

    /// The number m of positions.
    pub fn degrees_of_freedom(&self) -> usize {
        self.m
    }

    /// The first and the last time, in the direction of the run; equal if no step was made.
    pub fn interval(&self) -> (T, T) {
        let start = self.pieces.first().map_or(self.end, |piece| piece.time);
        (start, self.end)
    }

    /// (q, p) at time `t`; `None` outside the run.
    pub fn at(&self, t: T) -> Option<(Vec<T>, Vec<T>)> {
        let mut y = vec![T::int(0); 2 * self.m];
        self.at_into(t, &mut y).then(|| {
            let p = y.split_off(self.m);
            (y, p)
        })
    }

    /// Writes (q, p) at time `t` to `y`, of length 2m. Returns whether `t` is within the run. Nothing is
    /// allocated.
    ///
    /// # Panics
    /// If `y` has another length.
    pub fn at_into(&self, t: T, y: &mut [T]) -> bool {
        assert_eq!(y.len(), 2 * self.m, "the state has 2m components");
        let (start, end) = self.interval();
        let way = TimeDirection::between(start, end).unwrap_or_default();
        if way.is_before(t, start) || way.is_before(end, t) || t.is_nan() {
            return false;
        }
        let after = self
            .pieces
            .partition_point(|piece| !way.is_before(t, piece.time));
        let Some(piece) = after.checked_sub(1).and_then(|i| self.pieces.get(i)) else {
            return false;
        };
        piece.state_at(piece.place_of(t), y);
        true
    }
}
