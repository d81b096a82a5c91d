//! Dense output after every step of a run: it is stored, or the states at requested times are computed from
//! it.

use crate::dense::piece::Piece;
use crate::dense::refine::Refiner;
use crate::dense::trajectory::Trajectory;
use crate::error::IntegrateError;
use crate::events::watch::{EventWatch, EventsAt};
use crate::options::common::Options;
use crate::runs::run::Run;
use crate::steppers::integration::Integration;
use crate::time::direction::TimeDirection;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

/// Dense output of a run; exists only if requested.
#[derive(Debug)]
pub(crate) struct DenseWatch<T: Float> {
    refiner: Refiner<T>,
    trajectory: Option<Trajectory<T>>,
    events: Option<EventWatch<T>>,
    /// The requested times, and the number of times done.
    times: Vec<T>,
    done: usize,
    y: Vec<T>,
}

impl<T: Float> DenseWatch<T> {
    /// `times` are the output times to be served from dense output. `None` if dense output is not needed.
    pub(crate) fn new(
        system: &Hamiltonian,
        options: &Options<T>,
        times: &[T],
        stepper: &mut Integration<T>,
    ) -> Result<Option<Self>, IntegrateError<T>> {
        if !options.dense && options.events.is_empty() && times.is_empty() {
            return Ok(None);
        }
        stepper.core.keep_parts();
        let m = stepper.m;
        Ok(Some(DenseWatch {
            refiner: Refiner::new(system, stepper.core.method())?,
            trajectory: options.dense.then(|| Trajectory::new(m, stepper.time)),
            events: (!options.events.is_empty()).then(|| {
                let from = (stepper.time, stepper.direction);
                EventWatch::new(&options.events, 2 * m, from)
            }),
            times: times.to_vec(),
            done: 0,
            y: vec![T::int(0); 2 * m],
        }))
    }

    /// Processes the last step of `stepper`, which began at a time with the rounding remainder `time_low`, up
    /// to events that end the run or change its state.
    pub(crate) fn see(
        &mut self,
        stepper: &mut Integration<T>,
        time_low: T,
        run: &mut Run<T>,
    ) -> Result<Option<EventsAt<'_, T>>, IntegrateError<T>> {
        let ends: Vec<T> = stepper.times_of_ends().collect();
        for (i, end) in ends.into_iter().enumerate() {
            let is_due = |&t: &T| stepper.direction.is_before(t, end);
            let due = self.times.get(self.done).is_some_and(is_due);
            if !due && self.trajectory.is_none() && self.events.is_none() {
                continue;
            }
            let Some((part, end_state)) = stepper.parts_to_ends().nth(i) else {
                break;
            };
            let method = stepper.core.method();
            let (piece, is_refined) = self.refiner.refine((method, part), time_low, end_state);
            run.certificate.coarse_outputs += u64::from(!is_refined);
            let stop = match &mut self.events {
                Some(events) => events.see((&piece, end), &mut run.occurrences)?,
                None => None,
            };
            let (Some(place), Some(events)) = (stop, &mut self.events) else {
                self.output(piece, (end, stepper.direction), run);
                continue;
            };
            let part = part.clone();
            let step = stepper.step_to_event(&part, (&piece, place), events);
            let piece = match &step.made {
                Some((part, end)) => {
                    let method = stepper.core.method();
                    self.refiner.refine((method, part), time_low, end).0
                }
                None => piece,
            };
            let (time, step_of) = (step.time, (step.h, step.outcome));
            events.move_met(&mut run.occurrences, time, step.y.split_at(stepper.m));
            // Outputs use `y` as workspace.
            self.output(piece, (time, stepper.direction), run);
            self.y = step.y;
            let y = &self.y;
            let at = |events| EventsAt {
                events,
                time,
                y,
                step: step_of,
            };
            return Ok(self.events.as_mut().map(at));
        }
        Ok(None)
    }

    /// The outputs in `piece` before `end`, and the piece itself.
    fn output(&mut self, piece: Piece<T>, (end, direction): (T, TimeDirection), run: &mut Run<T>) {
        self.outputs(&piece, (end, direction), run);
        if let Some(trajectory) = &mut self.trajectory {
            trajectory.add(piece);
            trajectory.end_at(end);
        }
    }

    fn outputs(
        &mut self,
        piece: &Piece<T>,
        (end, direction): (T, TimeDirection),
        run: &mut Run<T>,
    ) {
        let is_due = |t: T| direction.is_before(t, end);
        while let Some(&time) = self.times.get(self.done).filter(|&&t| is_due(t)) {
            piece.state_at(piece.place_of(time), &mut self.y);
            run.output(time, &self.y);
            self.done += 1;
        }
    }

    /// The remaining outputs when the run has reached its end.
    pub(crate) fn last_outputs(&mut self, stepper: &Integration<T>, run: &mut Run<T>) {
        for &time in &self.times[self.done..] {
            run.output(time, &stepper.y.hi);
        }
        self.done = self.times.len();
        if let Some(trajectory) = &mut self.trajectory {
            trajectory.end_at(stepper.time);
        }
    }

    /// Moves the stored trajectory to `run`. Without a step it is the state of `stepper`.
    pub(crate) fn finish(self, stepper: &Integration<T>, run: &mut Run<T>) {
        run.trajectory = self.trajectory.map(|mut trajectory| {
            let (y, time) = (&stepper.y, stepper.time);
            if trajectory.is_empty() {
                trajectory.add(Piece::at_rest(y, time));
                trajectory.end_at(time);
            }
            trajectory
        });
    }
}
