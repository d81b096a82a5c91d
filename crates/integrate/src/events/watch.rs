//! Events along a run: roots in every piece of dense output, in the order of time.

use crate::dense::piece::Piece;
use crate::error::IntegrateError;
use crate::events::roots::Roots;
use crate::options::event::{Action, Direction, Event, EventFunction, Occurrence};
use crate::time::direction::TimeDirection;
use equip_scalar::Float;

#[derive(Debug)]
pub(crate) struct EventWatch<T: Float> {
    events: Vec<Event<T>>,
    functions: Vec<EventFunction<T>>,
    roots: Roots<T>,
    /// (place in the piece, event, rising).
    found: Vec<(T, usize, bool)>,
    y: Vec<T>,
    start: T,
    direction: TimeDirection,
    /// The event that ended the last piece.
    last: usize,
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
            last: 0,
        }
    }

    /// What the event that ended the last piece does to the state.
    pub(crate) fn action(&self) -> Option<Action<T>> {
        self.events.get(self.last)?.action.clone()
    }

    /// The run continues from another state at this time: a root there is none that it crosses.
    pub(crate) fn begin(&mut self, time: T) {
        self.start = time;
    }

    /// The run goes this way from here on.
    pub(crate) fn go(&mut self, direction: TimeDirection) {
        self.direction = direction;
    }

    /// Appends what happens in `piece` to `occurrences`. Returns the place in it where an event ends the run,
    /// or changes its state.
    pub(crate) fn see(
        &mut self,
        piece: &Piece<T>,
        occurrences: &mut Vec<Occurrence<T>>,
    ) -> Result<Option<T>, IntegrateError<T>> {
        let m = self.y.len() / 2;
        // Places closer than an ulp of the time are one.
        let largest = piece.time.abs().max(piece.time_at(T::int(1)).abs());
        let resolution =
            (T::EPSILON / T::int(2) * largest / piece.h.abs()).max(T::EPSILON / T::int(4));
        self.found.clear();
        let functions = self.events.iter().zip(&mut self.functions);
        for (number, (event, function)) in functions.enumerate() {
            let y = &mut self.y;
            let g = |place: T| {
                piece.state_at(place, y);
                function.value(piece.time_at(place), &y[..m], &y[m..])
            };
            self.roots
                .find(g, resolution)
                .map_err(|_| IntegrateError::EventTooRough {
                    event: event.name().to_owned(),
                    time: piece.time,
                    step: piece.h,
                })?;
            let wanted = self.roots.found.iter().filter(|(_, rising)| {
                event.direction == Direction::Both
                    || (event.direction == Direction::Rising) == *rising
            });
            self.found
                .extend(wanted.map(|&(place, rising)| (place, number, rising)));
        }
        self.found
            .sort_by(|a, b| a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal));
        for &(place, event, rising) in &self.found {
            let time = piece.time_at(place);
            // A run that starts on a root has not crossed it.
            if !self.direction.is_before(self.start, time) {
                continue;
            }
            piece.state_at(place, &mut self.y);
            let (q, p) = (self.y[..m].to_vec(), self.y[m..].to_vec());
            occurrences.push(Occurrence {
                event,
                time,
                q,
                p,
                rising,
            });
            if self.events[event].terminal || self.events[event].action.is_some() {
                self.last = event;
                return Ok(Some(place));
            }
        }
        Ok(None)
    }
}
