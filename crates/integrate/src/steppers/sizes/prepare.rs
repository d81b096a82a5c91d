//! A stepper with the step control of an integrator.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::memory::Memory;
use crate::error::IntegrateError;
use crate::options::integrator::{Integrator, StepSizes};
use crate::steppers::integration::Integration;
use crate::steppers::sizes::adaptive_steps::AdaptiveSteps;
use crate::steppers::sizes::fixed_steps::FixedSteps;
use crate::steppers::step_control::StepControl;
use crate::steppers::stepper::Stepper;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

impl<T: Float> Stepper<T> {
    /// Checks the options, and computes tables and workspace. The stepper has no initial state yet.
    pub(crate) fn prepare(
        integrator: &Integrator<T>,
        system: &Hamiltonian,
    ) -> Result<Self, IntegrateError<T>> {
        let mut inner;
        let control: Box<dyn StepControl<T>> = match &integrator.sizes {
            &StepSizes::Fixed(h) => {
                if h == T::int(0) || !h.is_finite() {
                    return Err(IntegrateError::StepOutOfRange { step: h });
                }
                inner = Integration::prepare(integrator, system)?;
                Box::new(FixedSteps::new(h))
            }
            StepSizes::Tolerance(sizes) => {
                sizes.validate(integrator.method)?;
                inner = Integration::prepare(integrator, system)?;
                Box::new(AdaptiveSteps::new(
                    sizes,
                    integrator.method,
                    system,
                    &mut inner,
                )?)
            }
        };
        Ok(Stepper { inner, control })
    }

    /// The run of `checkpoint`, at the step of the checkpoint.
    pub(crate) fn resume(
        integrator: &Integrator<T>,
        system: &Hamiltonian,
        checkpoint: &Checkpoint,
    ) -> Result<Self, IntegrateError<T>> {
        checkpoint.check::<T>(&integrator.words())?;
        let mut stepper = Self::prepare(integrator, system)?;
        // H(t, q, p) may be undefined at another pair of time and state.
        let (q, p) = checkpoint.start_state()?;
        let t0 = checkpoint.start.read_finite("the start")?;
        stepper.begin((&q, &p), t0, None)?;
        let Stepper { inner, control } = &mut stepper;
        inner.check_functions(checkpoint)?;
        let mut memory = Memory::to_read(&checkpoint.run);
        inner.restore_from(checkpoint, &mut memory)?;
        control.at_another_state(inner);
        control.remember(inner, &mut memory);
        memory.check()?;
        Ok(stepper)
    }
}
