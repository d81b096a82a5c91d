//! Events along a run: roots in every piece of dense output, in the order of time.

use crate::dense::piece::Piece;
use crate::error::IntegrateError;
use crate::events::roots::Roots;
use crate::options::event::{Direction, Event, EventFunction, Occurrence};
use crate::time::direction::TimeDirection;
use equip_scalar::Float;
use equip_solver::Outcome;
use std::ops::ControlFlow;

/// Units of rounding of the time within which two roots are at the same time (docs/adr/0033).
pub(crate) const CLOSEST: i64 = 256;
/// States at the same root differ by at most so many units of rounding (docs/adr/0036).
pub(crate) const ROUNDINGS: i64 = 4;

#[derive(Debug)]
pub(crate) struct EventWatch<T: Float> {
    events: Vec<Event<T>>,
    functions: Vec<EventFunction<T>>,
    roots: Roots<T>,
    /// (position in the piece, event, whether g rises).
    found: Vec<(T, usize, bool)>,
    y: Vec<T>,
    start: T,
    direction: TimeDirection,
    /// The events at the end of the last piece, in the order of the list, if one of them ended it.
    met: Vec<usize>,
    /// g of every event at the end of the last piece, and its derivative by the position there.
    at_end: Vec<[T; 2]>,
    /// The change of every component from the start of the last piece to the events met, and its time.
    moved: (Vec<T>, T),
}

/// Events that end a run or change its state, with the time and the state of their common root, and the size
/// and the outcome of the step that ends there.
pub(crate) struct EventsAt<'a, T: Float> {
    pub(crate) events: &'a mut EventWatch<T>,
    pub(crate) time: T,
    pub(crate) y: &'a [T],
    pub(crate) step: (T, Outcome),
}

impl<T: Float> EventWatch<T> {
    pub(crate) fn new(
        events: &[Event<T>],
        n: usize,
        (start, direction): (T, TimeDirection),
    ) -> Self {
        EventWatch {
            events: events.to_vec(),
            functions: events.iter().map(Event::function).collect(),
            roots: Roots::new(),
            found: Vec::new(),
            y: vec![T::int(0); n],
            start,
            direction,
            met: Vec::new(),
            at_end: Vec::new(),
            moved: (vec![T::int(0); n], T::int(0)),
        }
    }

    /// Computes every g and its derivative at the events met at `place` of `piece`.
    pub(crate) fn compare_with(&mut self, piece: &Piece<T>, place: T) {
        let m = self.y.len() / 2;
        let y = &mut self.y;
        // Difference quotients over this part of the step have the least error.
        let apart = T::EPSILON.sqrt().sqrt();
        let (moved, took) = &mut self.moved;
        *took = (place * piece.h).abs();
        piece.state_at(T::int(0), moved);
        piece.state_at(place, y);
        for (moved, &y) in moved.iter_mut().zip(&*y) {
            *moved = (y - *moved).abs();
        }
        self.at_end.clear();
        for function in &mut self.functions {
            let [before, at, behind] = [-apart, T::int(0), apart].map(|by| {
                piece.state_at(place + by, y);
                function.value(piece.time_at(place + by), &y[..m], &y[m..])
            });
            let derivative = (behind - before) / (T::int(2) * apart);
            self.at_end.push([at, derivative]);
        }
    }

    /// The correction of the position of the first event met, by g at the state (`q`, `p`), and the largest
    /// distance of the other events met from it. `None` if another g has not the sign that it has on the
    /// polynomial.
    pub(crate) fn corrections(&mut self, time: T, (q, p): (&[T], &[T])) -> Option<[T; 2]> {
        let mut first: Option<[T; 2]> = None;
        for (j, function) in self.functions.iter_mut().enumerate() {
            let (value, [expected, derivative]) = (function.value(time, q, p), self.at_end[j]);
            if !self.met.contains(&j) {
                if (value > T::int(0)) != (expected > T::int(0)) {
                    return None;
                }
                continue;
            }
            let by = -value / derivative;
            let [correction, spread] = first.get_or_insert([by, T::int(0)]);
            *spread = spread.max((by - *correction).abs());
        }
        first.filter(|by| by.iter().all(|by| by.is_finite()))
    }

    /// Changes the state `y` by the events that ended the last piece, in the order in which they are listed.
    /// Breaks if one of them ends the run.
    pub(crate) fn change(&self, time: T, y: &mut [T]) -> ControlFlow<()> {
        let (q, p) = y.split_at_mut(y.len() / 2);
        let met = self.met.iter().map(|&event| &self.events[event]);
        for action in met.clone().filter_map(|event| event.action.as_ref()) {
            action(time, q, p)?;
        }
        if met.clone().any(|event| event.terminal) {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    /// Moves the events met, the last `occurrences`, to this time and state.
    pub(crate) fn move_met(
        &self,
        occurrences: &mut [Occurrence<T>],
        time: T,
        (q, p): (&[T], &[T]),
    ) {
        for occurrence in occurrences.iter_mut().rev().take(self.met.len()) {
            occurrence.time = time;
            occurrence.q.copy_from_slice(q);
            occurrence.p.copy_from_slice(p);
        }
    }

    /// The name of the event that changed the state last.
    pub(crate) fn changing(&self) -> String {
        let mut met = self.met.iter().map(|&event| &self.events[event]);
        let changing = met.find(|event| event.action.is_some());
        changing
            .map(|event| event.name().to_owned())
            .unwrap_or_default()
    }

    /// Continues from another state at this time. A root at this time is not crossed.
    pub(crate) fn begin(&mut self, time: T) {
        self.start = time;
        self.met.clear();
        self.moved.0.fill(T::int(0));
        self.moved.1 = T::int(0);
    }

    /// Continues from the state that the events of the last piece have changed, at their time.
    pub(crate) fn continue_changed(&mut self, time: T) {
        self.start = time;
    }

    /// Sets the direction of the run, which may have been reversed at this time.
    pub(crate) fn go(&mut self, direction: TimeDirection, time: T) {
        if self.direction != direction {
            (self.direction, self.start) = (direction, time);
        }
    }

    /// Appends the events in `piece`, which ends at the time `end`, to `occurrences`. Returns the position in
    /// the piece where an event ends the run or changes its state. Events within [`CLOSEST`] roundings of the
    /// time are simultaneous.
    pub(crate) fn see(
        &mut self,
        (piece, end): (&Piece<T>, T),
        occurrences: &mut Vec<Occurrence<T>>,
    ) -> Result<Option<T>, IntegrateError<T>> {
        let m = self.y.len() / 2;
        // Where one piece ends and the next one begins, g has one value.
        let time_at = |place: T| {
            if place == T::int(1) {
                end
            } else {
                piece.time_at(place)
            }
        };
        // Positions closer than an ulp of the time are equal.
        let largest = piece.time.abs().max(end.abs());
        let resolution =
            (T::EPSILON / T::int(2) * largest / piece.h.abs()).max(T::EPSILON / T::int(4));
        let closest = T::int(2 * CLOSEST) * resolution;
        self.found.clear();
        let functions = self.events.iter().zip(&mut self.functions);
        for (number, (event, function)) in functions.enumerate() {
            let y = &mut self.y;
            let g = |place: T| {
                piece.state_at(place, y);
                function.value(time_at(place), &y[..m], &y[m..])
            };
            let found = self.roots.find(g, resolution);
            found.map_err(|_| IntegrateError::EventTooRough {
                event: event.name().to_owned(),
                time: piece.time,
                step: piece.h,
            })?;
            // A state that begins on a root is on either side of it by rounding. After a bounce g moves away
            // from the root first; a root that g only approaches is the one on which the state begins.
            if piece.time == self.start {
                let (at_start, noise) = noise_at_start(piece, function, &self.moved, y);
                let mut begins_on = |root: T, rises: bool| {
                    piece.state_at(root / T::int(2), y);
                    let middle = piece.time_at(root / T::int(2));
                    let middle = function.value(middle, &y[..m], &y[m..]);
                    let approaches = middle == at_start || (middle > at_start) == rises;
                    at_start.abs().max(middle.abs()) <= noise || (root <= closest && approaches)
                };
                let found = &mut self.roots.found;
                let begun = found
                    .iter()
                    .take_while(|&&(root, rises)| begins_on(root, rises));
                let begun = begun.count();
                found.drain(..begun);
            }
            let wanted = self.roots.found.iter().filter(|(place, rising)| {
                // A run that starts on a root has not crossed it.
                let is_crossed = self.direction.is_before(self.start, time_at(*place));
                let rises = event.direction == Direction::Rising;
                is_crossed && (event.direction == Direction::Both || rises == *rising)
            });
            self.found
                .extend(wanted.map(|&(place, rising)| (place, number, rising)));
        }
        self.found
            .sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
        let acts = |event: &Event<T>| event.terminal || event.action.is_some();
        let mut acting = self
            .found
            .iter()
            .filter(|found| acts(&self.events[found.1]));
        let acts_at = acting.next().map(|&(place, ..)| place);
        self.met.clear();
        for &(place, event, rising) in &self.found {
            if let Some(acts_at) = acts_at
                && place >= acts_at - closest
            {
                if place > acts_at + closest {
                    break;
                }
                if self.met.contains(&event) {
                    continue;
                }
                self.met.push(event);
            }
            piece.state_at(place, &mut self.y);
            let (q, p) = (self.y[..m].to_vec(), self.y[m..].to_vec());
            occurrences.push(Occurrence {
                event,
                time: time_at(place),
                q,
                p,
                rising,
            });
        }
        self.met.sort_unstable();
        Ok(acts_at)
    }
}

/// g at the start of `piece`, and its change if state and time change by twice [`ROUNDINGS`] units of
/// rounding of themselves and of the step that `moved` them there, for two choices of signs. `y` is
/// workspace.
fn noise_at_start<T: Float>(
    piece: &Piece<T>,
    function: &mut EventFunction<T>,
    (moved, took): &(Vec<T>, T),
    y: &mut [T],
) -> (T, T) {
    let m = y.len() / 2;
    let rounded = |x: T, size: T, sign: i64| x + T::int(2 * sign * ROUNDINGS) * T::EPSILON * size;
    let mut at = |signs: [i64; 2]| {
        piece.state_at(T::int(0), y);
        for (i, (y, &moved)) in y.iter_mut().zip(moved).enumerate() {
            *y = rounded(*y, y.abs() + moved, signs[i % 2]);
        }
        let time = rounded(piece.time, piece.time.abs() + *took, signs[0]);
        function.value(time, &y[..m], &y[m..])
    };
    let [value, same, opposite] = [[0, 0], [1, 1], [1, -1]].map(&mut at);
    (value, (same - value).abs().max((opposite - value).abs()))
}
