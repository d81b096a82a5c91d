//! Events along a run: roots in every piece of dense output, in the order of time.

use crate::dense::piece::Piece;
use crate::error::IntegrateError;
use crate::events::roots::Roots;
use crate::options::event::{Direction, Event, EventFunction, Occurrence};
use crate::time::direction::TimeDirection;
use equip_scalar::Float;
use std::ops::ControlFlow;

/// Units of rounding of the time within which two roots are at the same time (docs/adr/0033).
pub(crate) const CLOSEST: i64 = 256;

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
}

/// Events that end a run or change its state, with the time and the state of their common root.
pub(crate) struct EventsAt<'a, T: Float> {
    pub(crate) events: &'a mut EventWatch<T>,
    pub(crate) time: T,
    pub(crate) y: &'a [T],
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
        }
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

    /// The time since the start of the run or the last change of its state.
    pub(crate) fn since(&self, time: T) -> T {
        (time - self.start).abs()
    }

    /// Appends the events in `piece` to `occurrences`. Returns the position in the piece where an event ends
    /// the run or changes its state. Events within [`CLOSEST`] roundings of the time are simultaneous.
    pub(crate) fn see(
        &mut self,
        piece: &Piece<T>,
        occurrences: &mut Vec<Occurrence<T>>,
    ) -> Result<Option<T>, IntegrateError<T>> {
        let m = self.y.len() / 2;
        // Positions closer than an ulp of the time are equal.
        let largest = piece.time.abs().max(piece.time_at(T::int(1)).abs());
        let resolution =
            (T::EPSILON / T::int(2) * largest / piece.h.abs()).max(T::EPSILON / T::int(4));
        let closest = T::int(2 * CLOSEST) * resolution;
        self.found.clear();
        let functions = self.events.iter().zip(&mut self.functions);
        for (number, (event, function)) in functions.enumerate() {
            let y = &mut self.y;
            let mut g = |place: T| {
                piece.state_at(place, y);
                function.value(piece.time_at(place), &y[..m], &y[m..])
            };
            let found = self.roots.find(&mut g, resolution);
            found.map_err(|_| IntegrateError::EventTooRough {
                event: event.name().to_owned(),
                time: piece.time,
                step: piece.h,
            })?;
            // The state begins on the events met last, on either side by rounding. A root that g only
            // approaches from there is the root on which the state begins.
            if self.met.contains(&number)
                && let Some(&(root, rises)) = self.roots.found.first()
                && root <= closest
            {
                let nears = g(root / T::int(2)) - g(T::int(0));
                if nears == T::int(0) || (nears > T::int(0)) == rises {
                    self.roots.found.remove(0);
                }
            }
            let wanted = self.roots.found.iter().filter(|(place, rising)| {
                // A run that starts on a root has not crossed it.
                let is_crossed = self.direction.is_before(self.start, piece.time_at(*place));
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
        let end = acting.next().map(|&(place, ..)| place);
        self.met.clear();
        for &(place, event, rising) in &self.found {
            if let Some(end) = end
                && place >= end - closest
            {
                if place > end + closest {
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
                time: piece.time_at(place),
                q,
                p,
                rising,
            });
        }
        self.met.sort_unstable();
        Ok(end)
    }
}
