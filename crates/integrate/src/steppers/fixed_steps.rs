//! Steps of one size, made by a [`Stepper`] as it is.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::options::common::Words;
use crate::options::fixed_step::Fixed;
use crate::options::integrator::Integrator;
use crate::steppers::grid::Grid;
use crate::steppers::sizes::{Advance, StepSizes};
use crate::steppers::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;

impl<T: Float, E: Evaluate<T>> Advance<T, E> for Stepper<T, E> {
    fn inner(&self) -> &Stepper<T, E> {
        self
    }

    fn inner_mut(&mut self) -> &mut Stepper<T, E> {
        self
    }

    fn begin(&mut self, q0: &[T], p0: &[T], t0: T) -> Result<(), IntegrateError<T>> {
        self.start_at(q0, p0, t0)
    }

    fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), IntegrateError<T>> {
        self.restore_from(checkpoint)
    }

    fn save(&mut self) -> Checkpoint {
        self.checkpoint()
    }

    fn set_end(&mut self, end: T) -> Result<(), IntegrateError<T>> {
        let h = self.h.unwrap_or(T::int(0));
        let grid = Grid::new(self.t0, end.max(self.time), h)?;
        // The last step of a run that is over may be shorter than the grid's.
        if self.index > grid.steps() || grid.time(self.index) != self.time {
            return Err(IntegrateError::CheckpointOffGrid { time: self.time });
        }
        self.grid = Some(grid);
        Ok(())
    }

    fn is_done(&self) -> bool {
        self.grid.is_some_and(|grid| self.index >= grid.steps())
    }

    fn step(&mut self) -> Result<(), IntegrateError<T>> {
        match self.grid {
            Some(grid) => {
                let (time, h) = (grid.time(self.index + 1), grid.size(self.index + 1));
                self.advance_to(time, h).map(|_| ())
            }
            None => self.advance().map(|_| ()),
        }
    }

    fn time_low(&self) -> T {
        T::int(0)
    }

    fn next_time(&self) -> Option<T> {
        self.grid.map(|grid| grid.time(self.index + 1))
    }
}

impl<T: Float> StepSizes<T> for Fixed<T> {
    type Stepper<E: Evaluate<T>> = Stepper<T, E>;

    fn stepper<H: System>(
        integrator: &Integrator<T, Self>,
        system: &H,
    ) -> Result<Stepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        integrator.sizes.validate()?;
        Stepper::prepare(
            integrator,
            system,
            Some(integrator.sizes.h),
            integrator.words(),
        )
    }

    fn words(&self) -> Words {
        vec![
            ("steps", "of one size".to_owned()),
            ("step", format!("{:?}", self.h)),
        ]
    }
}
