//! How far α's may move the end point, and how they come to rest.

use crate::policy::{STATE_ROUNDING, TURNS};
use equip_scalar::Float;

/// How far the end point has to be moved at least to keep the constraints, and how far it may be, in units of
/// the motion: of each component, and of the one of its group that moves most.
pub(crate) struct Bounds<T> {
    pub(crate) needed: T,
    /// Of the first direction.
    pub(crate) tolerance: T,
    pub(crate) most: [T; 2],
    /// What is a small share of the motion: what moves further is no correction of a step.
    pub(crate) small: T,
    /// The local error has been asked for.
    pub(crate) has_error: bool,
}

impl<T: Float> Bounds<T> {
    pub(crate) fn is_small(&self, far: [T; 2]) -> bool {
        far.iter().all(|&far| far <= self.small)
    }

    pub(crate) fn holds(&self, far: [T; 2]) -> bool {
        self.is_small(far) && far.iter().zip(&self.most).all(|(far, most)| far <= most)
    }
}

/// How the α's of a step have moved so far.
pub(crate) struct Progress<T> {
    /// The largest displacement of the end point by a move, in units of the state.
    pub(crate) farthest: T,
    /// How far the stages have moved since the direction was taken, in units of the motion.
    since: Option<T>,
    /// Defects in floors, and the displacement of the end point, before the last move.
    last: Option<[T; 2]>,
    moves: u32,
    stalls: u32,
}

impl<T: Float> Progress<T> {
    pub(crate) fn new() -> Self {
        Progress {
            farthest: T::int(0),
            since: None,
            last: None,
            moves: 0,
            stalls: 0,
        }
    }

    /// By how much the direction has turned since it was taken, as it shows in the end point.
    pub(crate) fn turns(&self) -> Option<T> {
        let since = self.since?;
        Some(T::int(TURNS) * self.farthest * since)
    }

    /// A direction was taken to this relative tolerance.
    pub(crate) fn direction_taken(&mut self, tolerance: T) {
        self.since = Some(tolerance / T::int(TURNS));
    }

    /// How many moves but the first have halved neither what is left of the defects nor what the next is to
    /// move the end point by.
    pub(crate) fn stalls(&mut self, floors: T, of_state: T) -> u32 {
        let two = T::int(2);
        let shrinks = self.last.is_none_or(|[last_floors, last_state]| {
            two * floors <= last_floors || two * of_state <= last_state
        });
        self.last = Some([floors, of_state]);
        self.stalls += u32::from(self.moves > 1 && !shrinks);
        self.stalls
    }

    /// The α's are to move the stages and the end point so far.
    pub(crate) fn moves(&mut self, of_stages: T, of_state: T) {
        self.moves += 1;
        self.farthest = self.farthest.max(of_state);
        self.since = self.since.map(|since| since + of_stages);
    }
}

/// The relative tolerance of a direction that turns by so much yet and moves the end point so `far`: what
/// shows in the end point, and no better than it turns.
pub(crate) fn direction_tolerance<T: Float>(turns: T, far: T) -> T {
    let rounding = T::int(STATE_ROUNDING) * T::EPSILON;
    (rounding / far / T::int(TURNS))
        .max(turns)
        .max(rounding)
        .min(T::ratio(1, 1000))
}
