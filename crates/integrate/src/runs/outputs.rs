//! Output between the points of a grid.

use crate::error::IntegrateError;
use crate::runs::run::Run;
use crate::steppers::stepper::Stepper;
use equip_autodiff::Evaluate;
use equip_scalar::Float;

/// States at chosen times: one step of the same method from the last grid point, to each.
#[derive(Debug)]
pub(crate) struct Outputs<'a, T: Float, E> {
    stepper: Stepper<T, E>,
    times: &'a [T],
    done: usize,
}

impl<'a, T: Float, E: Evaluate<T>> Outputs<'a, T, E> {
    /// The steps are made by `stepper`.
    pub(crate) fn new(stepper: Stepper<T, E>, times: &'a [T]) -> Self {
        Outputs {
            stepper,
            times,
            done: 0,
        }
    }

    /// The run continues from another state within the step: outputs beyond it are made again.
    pub(crate) fn rewind(&mut self, run: &Run<T>) {
        self.done = run.output_count();
    }

    /// Makes the outputs before `end`, or all that are left, starting from the state that `main` has now.
    pub(crate) fn up_to(
        &mut self,
        main: &Stepper<T, E>,
        end: Option<T>,
        run: &mut Run<T>,
    ) -> Result<(), IntegrateError<T>> {
        let is_due = |time: T| end.is_none_or(|end| main.direction.is_before(time, end));
        while let Some(&time) = self.times.get(self.done).filter(|&&time| is_due(time)) {
            let h = time - main.time();
            if main.direction.is_before(main.time(), time) {
                self.stepper.core.forget();
                let side = &mut self.stepper;
                run.output(time, side.aside((&main.y, main.time()), h)?);
                run.certificate.output_steps += 1;
            } else {
                run.output(time, &main.y.hi);
            }
            self.done += 1;
        }
        Ok(())
    }
}
