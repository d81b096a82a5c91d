//! [`FixedSteps`]: steps of one size on a grid of time.

use crate::checkpoints::memory::Memory;
use crate::error::IntegrateError;
use crate::steppers::integration::Integration;
use crate::steppers::sizes::grid::{Grid, is_same_time};
use crate::steppers::step_control::{StepControl, way};
use crate::time::direction::TimeDirection;
use equip_scalar::Float;
use std::slice::from_mut;

/// The grid t_g + n h.
#[derive(Debug)]
pub(super) struct FixedSteps<T> {
    /// The size of the steps, without sign.
    size: T,
    /// The direction of a run, unless its end determines the direction.
    first_direction: TimeDirection,
    /// The start of the grid, and the number of steps from there in the direction of the run.
    start: T,
    place: i64,
    /// The grid up to the end of the run, if it is known.
    grid: Option<Grid<T>>,
}

impl<T: Float> FixedSteps<T> {
    /// Steps of size `h`. The sign is the initial direction of the run.
    pub(super) fn new(h: T) -> Self {
        FixedSteps {
            size: h.abs(),
            first_direction: TimeDirection::between(T::int(0), h).unwrap_or_default(),
            start: T::int(0),
            place: 0,
            grid: None,
        }
    }

    /// The signed step.
    fn step_of(&self, run: &Integration<T>) -> T {
        run.direction.signed(self.size)
    }

    /// Whether the run is at a point of the grid, up to the rounding of time.
    fn is_on_grid(&self, run: &Integration<T>) -> bool {
        let point = self.start + T::int(self.place) * self.step_of(run);
        is_same_time(point, run.time, self.start)
    }

    /// Restarts the grid at the present time.
    fn begin_grid(&mut self, run: &Integration<T>) {
        (self.start, self.place) = (run.time, 0);
    }

    /// Makes a step of the signed size `h`, which ends at `time`.
    fn make(&mut self, run: &mut Integration<T>, time: T, h: T) -> Result<(), IntegrateError<T>> {
        if !run.direction.is_before(run.time, time) {
            let (step, time) = (h, run.time);
            return Err(IntegrateError::StepBelowTimeResolution { step, time });
        }
        let outcome = run.attempt_in_parts(h)?;
        run.accept(time, h, outcome);
        self.place += 1;
        Ok(())
    }
}

impl<T: Float> StepControl<T> for FixedSteps<T> {
    fn begin(
        &mut self,
        run: &mut Integration<T>,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<(), IntegrateError<T>> {
        let to_end = way(t0, towards)?;
        let step = self.size;
        if t0 + step == t0 {
            return Err(IntegrateError::StepBelowTimeResolution { step, time: t0 });
        }
        let direction = to_end.unwrap_or(self.first_direction);
        let has_sign = self.first_direction == TimeDirection::Backward;
        if let (true, TimeDirection::Forward, Some(end)) = (has_sign, direction, towards) {
            let (step, start) = (-step, t0);
            return Err(IntegrateError::StepsLeadAway { step, start, end });
        }
        run.start_at(start, t0, direction)?;
        (self.start, self.place, self.grid) = (t0, 0, None);
        Ok(())
    }

    fn remember(&mut self, _: &mut Integration<T>, memory: &mut Memory<'_>) {
        memory.finite("the start of the grid", from_mut(&mut self.start));
        self.place = memory.whole::<T>("the place on the grid", self.place);
    }

    fn set_end(&mut self, run: &Integration<T>, end: T) -> Result<(), IntegrateError<T>> {
        // The last step of a finished run may be shorter than a step of the grid.
        if !self.is_on_grid(run) {
            return Err(IntegrateError::CheckpointOffGrid { time: run.time });
        }
        let is_over = run.direction.is_before(end, run.time);
        let end = if is_over { run.time } else { end };
        self.grid = Some(Grid::new(self.start, end, self.step_of(run))?);
        Ok(())
    }

    fn is_done(&self, _: &Integration<T>) -> bool {
        self.grid.is_some_and(|grid| self.place >= grid.last())
    }

    fn at_another_state(&mut self, _: &mut Integration<T>) {}

    fn at_another_time(&mut self, run: &mut Integration<T>, _: T) -> Result<(), IntegrateError<T>> {
        self.begin_grid(run);
        if let Some(grid) = self.grid {
            self.grid = Some(Grid::new(run.time, grid.end(), self.step_of(run))?);
        }
        Ok(())
    }

    fn turn_back(&mut self, run: &mut Integration<T>) {
        run.direction = run.direction.turned();
        self.place = -self.place;
        self.grid = None;
    }

    fn step(&mut self, run: &mut Integration<T>, meets_end: bool) -> Result<(), IntegrateError<T>> {
        if let Some(grid) = self.grid.filter(|_| meets_end) {
            let next = self.place + 1;
            return self.make(run, grid.time(next), grid.size(next));
        }
        if !self.is_on_grid(run) {
            self.begin_grid(run);
        }
        let h = self.step_of(run);
        let time = self.start + T::int(self.place + 1) * h;
        self.make(run, time, h)
    }

    fn step_towards(&mut self, run: &mut Integration<T>, t: T) -> Result<bool, IntegrateError<T>> {
        let has_passed = run.has_passed(t)?;
        if is_same_time(t, run.time, self.start) {
            run.time = t;
            return Ok(false);
        }
        if has_passed {
            self.turn_back(run);
        }
        if !self.is_on_grid(run) {
            self.begin_grid(run);
        }
        let grid = Grid::new(self.start, t, self.step_of(run))?;
        let next = self.place + 1;
        if next > grid.last() {
            // The run is at `t` up to the rounding of time.
            run.time = t;
            return Ok(false);
        }
        self.make(run, grid.time(next), grid.size(next))?;
        Ok(true)
    }

    fn time_low(&self) -> T {
        T::int(0)
    }

    fn next_step(&self) -> T {
        self.size
    }

    fn next_time(&self) -> Option<T> {
        self.grid.map(|grid| grid.time(self.place + 1))
    }
}
