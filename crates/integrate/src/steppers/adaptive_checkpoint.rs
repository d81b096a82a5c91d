//! Checkpoints of runs with variable steps: those of fixed steps, and what control remembers.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::exact::Exact;
use crate::checkpoints::memories::ControlMemory;
use crate::control::controller::Memory;
use crate::error::IntegrateError;
use crate::options::adaptive::Adaptive;
use crate::report::variable_steps::VariableSteps;
use crate::steppers::adaptive_stepper::AdaptiveStepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;

impl<T: Float> Adaptive<T> {
    /// The run that `checkpoint` was made of, at the step where it was made. Bit for bit the same as if it had not stopped.
    ///
    /// # Errors
    /// See [`FixedStep::resume`](crate::FixedStep::resume).
    pub fn resume<H: System>(
        &self,
        system: &H,
        checkpoint: &Checkpoint,
    ) -> Result<AdaptiveStepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        let inner = (self.base).resume_as(system, checkpoint, self.fingerprint())?;
        let Some(memory) = &checkpoint.control else {
            return Err(IntegrateError::CheckpointDamaged {
                what: "the memory of step control",
            });
        };
        let settings = self.validate()?;
        let mut stepper = self.around(inner, settings.stages);
        stepper.time_low = checkpoint.time_low.read()?;
        let float = |x: &Exact| x.read::<T>().map(Float::to_f64);
        stepper.control.memory = Memory {
            next: float(&memory.next)?,
            held: float(&memory.held)?,
        };
        stepper.tries = memory.tries;
        stepper.inner.variable = Some(VariableSteps {
            tolerance: self.tolerance,
            smallest: memory.smallest.read()?,
            largest: memory.largest.read()?,
            rejected: memory.rejected,
            failed: memory.failed,
        });
        Ok(stepper)
    }

    /// What has to be the same again.
    pub(crate) fn fingerprint(&self) -> String {
        format!(
            "tolerance {:?}, scales {:?}, first step {:?}, steps {:?} to {:?}; {}",
            self.tolerance,
            self.scales,
            self.first_step,
            self.min_step,
            self.max_step,
            self.base.common_fingerprint()
        )
    }
}

impl<T: Float, E: Evaluate<T>> AdaptiveStepper<T, E> {
    /// The run as it is now, to be resumed by the same options.
    pub fn checkpoint(&mut self) -> Checkpoint {
        let mut checkpoint = self.inner.checkpoint();
        checkpoint.time_low = Exact::of(self.time_low);
        let Memory { next, held } = self.control.memory;
        checkpoint.control = self.inner.variable.map(|steps| ControlMemory {
            next: Exact::of(next),
            held: Exact::of(held),
            tries: self.tries,
            smallest: Exact::of(steps.smallest),
            largest: Exact::of(steps.largest),
            rejected: steps.rejected,
            failed: steps.failed,
        });
        checkpoint
    }
}
