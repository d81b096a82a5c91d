//! Steps of one size, made by a [`Stepper`] as it is.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::error::IntegrateError;
use crate::options::common::{Words, in_digits};
use crate::options::fixed_step::Fixed;
use crate::options::integrator::Integrator;
use crate::steppers::grid::Grid;
use crate::steppers::sizes::{Advance, Sizes};
use crate::steppers::stepper::Stepper;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

impl<T: Float> Advance<T> for Stepper<T> {
    fn inner(&self) -> &Stepper<T> {
        self
    }

    fn inner_mut(&mut self) -> &mut Stepper<T> {
        self
    }

    fn begin(
        &mut self,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<(), IntegrateError<T>> {
        self.start_at(start, t0, towards)
    }

    fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), IntegrateError<T>> {
        self.restore_from(checkpoint)
    }

    fn save(&mut self) -> Checkpoint {
        self.checkpoint()
    }

    fn set_end(&mut self, end: T) -> Result<(), IntegrateError<T>> {
        // The last step of a run that is over may be shorter than the grid's.
        if !self.is_on_grid() {
            return Err(IntegrateError::CheckpointOffGrid { time: self.time });
        }
        let is_over = self.direction.is_before(end, self.time);
        let end = if is_over { self.time } else { end };
        self.grid = Some(Grid::new(self.grid_start, end, self.grid_step())?);
        Ok(())
    }

    fn kick(&mut self, (q, p): (&[T], &[T]), t: T) -> Result<(), IntegrateError<T>> {
        self.move_to(q, p, t)?;
        self.time = t;
        self.begin_grid();
        if let Some(grid) = self.grid {
            self.grid = Some(Grid::new(t, grid.end(), self.grid_step())?);
        }
        Ok(())
    }

    fn is_done(&self) -> bool {
        self.grid.is_some_and(|grid| self.place >= grid.last())
    }

    fn go_on(&mut self) -> Result<(), IntegrateError<T>> {
        if !self.is_on_grid() {
            self.begin_grid();
        }
        let h = self.grid_step();
        let time = self.grid_start + T::int(self.place + 1) * h;
        self.make(time, h)
    }

    fn step(&mut self) -> Result<(), IntegrateError<T>> {
        match self.grid {
            Some(grid) => {
                let next = self.place + 1;
                self.make(grid.time(next), grid.size(next))
            }
            None => self.go_on(),
        }
    }

    fn step_towards(&mut self, t: T) -> Result<bool, IntegrateError<T>> {
        let has_passed = self.has_passed(t)?;
        if self.is_at(t) {
            self.time = t;
            return Ok(false);
        }
        if has_passed {
            self.turn_back();
        }
        if !self.is_on_grid() {
            self.begin_grid();
        }
        let (grid, next) = (
            Grid::new(self.grid_start, t, self.grid_step())?,
            self.place + 1,
        );
        if next > grid.last() {
            // Within the rounding of time it is there.
            self.time = t;
            return Ok(false);
        }
        let time = if next == grid.last() {
            t
        } else {
            grid.time(next)
        };
        self.make(time, grid.size(next))?;
        Ok(true)
    }

    fn time_low(&self) -> T {
        T::int(0)
    }

    fn next_time(&self) -> Option<T> {
        self.grid.map(|grid| grid.time(self.place + 1))
    }
}

impl<T: Float> Sizes<T> for Fixed<T> {
    type Stepper = Stepper<T>;

    fn stepper(
        integrator: &Integrator<T, Self>,
        system: &Hamiltonian,
    ) -> Result<Stepper<T>, IntegrateError<T>> {
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
            ("step", in_digits(self.h.abs())),
        ]
    }
}
