//! What a run does with dense output after every step: keep it, or take the states at chosen times from it.

use crate::dense::{Piece, Refiner};
use crate::dense_trajectory::Trajectory;
use crate::error::IntegrateError;
use crate::options::FixedStep;
use crate::run::Run;
use crate::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;

/// Dense output of a run; made only if something asks for it.
#[derive(Debug)]
pub(crate) struct DenseWatch<T: Float, E> {
    refiner: Refiner<T, E>,
    trajectory: Option<Trajectory<T>>,
    /// Times asked for, and how many are done.
    times: Vec<T>,
    done: usize,
    y: Vec<T>,
}

impl<T: Float, E: Evaluate<T>> DenseWatch<T, E> {
    /// `times` are to be served from dense output. `None` if nothing asks for it.
    pub(crate) fn new<H: System<Evaluator<T> = E>>(
        system: &H,
        options: &FixedStep<T>,
        times: &[T],
        stepper: &mut Stepper<T, E>,
    ) -> Result<Option<Self>, IntegrateError<T>> {
        if !options.dense && times.is_empty() {
            return Ok(None);
        }
        stepper.core.parts.wanted = true;
        let m = system.degrees_of_freedom();
        let (iterations, solver) = (options.max_iterations, options.stage_solver);
        Ok(Some(DenseWatch {
            refiner: Refiner::new(system, &stepper.core.stages.gauss, iterations, solver)?,
            trajectory: options.dense.then(|| Trajectory::new(m, stepper.time())),
            times: times.to_vec(),
            done: 0,
            y: vec![T::int(0); 2 * m],
        }))
    }

    /// Sees the step that `stepper` has just made from a time whose lost part was `time_low`.
    pub(crate) fn see(
        &mut self,
        stepper: &Stepper<T, E>,
        time_low: T,
        run: &mut Run<T>,
    ) -> Result<(), IntegrateError<T>> {
        let parts = stepper.core.parts.all();
        for (i, part) in parts.iter().enumerate() {
            let next = parts.get(i + 1);
            let end = next.map_or(stepper.time(), |next| next.time);
            let due = self.times.get(self.done).is_some_and(|&t| t < end);
            if !due && self.trajectory.is_none() {
                continue;
            }
            let end_state = next.map_or(&stepper.y, |next| &next.start);
            let piece = self.refiner.refine(part, time_low, end_state)?;
            self.outputs(&piece, end, run);
            if let Some(trajectory) = &mut self.trajectory {
                trajectory.add(piece);
            }
        }
        Ok(())
    }

    fn outputs(&mut self, piece: &Piece<T>, end: T, run: &mut Run<T>) {
        while let Some(&time) = self.times.get(self.done).filter(|&&t| t < end) {
            piece.state_at(piece.place_of(time), &mut self.y);
            run.output(time, &self.y);
            self.done += 1;
        }
    }

    /// The run ends with the state that `stepper` has.
    pub(crate) fn finish(mut self, stepper: &Stepper<T, E>, run: &mut Run<T>) {
        while let Some(&time) = self.times.get(self.done).filter(|&&t| t <= stepper.time()) {
            run.output(time, &stepper.y.hi);
            self.done += 1;
        }
        if let Some(trajectory) = &mut self.trajectory {
            trajectory.end_at(stepper.time());
        }
        run.trajectory = self.trajectory;
    }
}
