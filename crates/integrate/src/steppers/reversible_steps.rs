//! Reversible sizes: the stepper that makes them, and its checkpoints.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::exact::Exact;
use crate::control::step_density::StepDensity;
use crate::error::IntegrateError;
use crate::options::common::Words;
use crate::options::integrator::Integrator;
use crate::options::reversible::Symmetric;
use crate::steppers::reversible_stepper::ReversibleStepper;
use crate::steppers::sizes::{Advance, StepSizes};
use crate::steppers::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;

impl<T: Float> StepSizes<T> for Symmetric<T> {
    type Stepper<E: Evaluate<T>> = ReversibleStepper<T, E>;

    fn stepper<H: System>(
        integrator: &Integrator<T, Self>,
        system: &H,
    ) -> Result<ReversibleStepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        let sizes = &integrator.sizes;
        sizes.validate()?;
        let inner = Stepper::prepare(integrator, system, None, integrator.words())?;
        let (n, stages) = (inner.y.hi.len(), inner.core.gauss().stages());
        Ok(ReversibleStepper {
            sigma: StepDensity::new(system, sizes.sigma.as_ref())?,
            rule: sizes.rule,
            epsilon: sizes.epsilon,
            density: T::int(0),
            time_low: T::int(0),
            end: T::INFINITY,
            points: vec![T::int(0); stages * n],
            inner,
        })
    }

    fn words(&self) -> Words {
        let sigma = if self.sigma.is_some() {
            "given"
        } else {
            "automatic"
        };
        vec![
            ("steps", "reversible".to_owned()),
            ("rule", format!("{:?}", self.rule)),
            ("epsilon", format!("{:?}", self.epsilon)),
            ("sigma", sigma.to_owned()),
        ]
    }
}

impl<T: Float, E: Evaluate<T>> Advance<T, E> for ReversibleStepper<T, E> {
    fn inner(&self) -> &Stepper<T, E> {
        &self.inner
    }

    fn inner_mut(&mut self) -> &mut Stepper<T, E> {
        &mut self.inner
    }

    fn begin(&mut self, q0: &[T], p0: &[T], t0: T) -> Result<(), IntegrateError<T>> {
        self.restart(q0, p0, t0)
    }

    fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), IntegrateError<T>> {
        self.inner.restore_from(checkpoint)?;
        let memory = checkpoint.control()?;
        self.density = memory.next.read_finite("the step density")?;
        self.time_low = checkpoint.time_low.read_finite("the time")?;
        self.inner.variable = Some(memory.variable_steps(self.epsilon)?);
        Ok(())
    }

    fn save(&mut self) -> Checkpoint {
        self.checkpoint()
    }

    fn set_end(&mut self, end: T) -> Result<(), IntegrateError<T>> {
        self.end = end;
        Ok(())
    }

    fn is_done(&self) -> bool {
        !(self.inner.time() < self.end)
    }

    fn step(&mut self) -> Result<(), IntegrateError<T>> {
        self.advance().map(|_| ())
    }

    fn time_low(&self) -> T {
        self.time_low
    }
}

impl<T: Float, E: Evaluate<T>> ReversibleStepper<T, E> {
    /// The present state of the run, to be resumed by the same options.
    pub fn checkpoint(&mut self) -> Checkpoint {
        let next = Exact::of(self.density);
        self.inner.variable_checkpoint(self.time_low, next, 0)
    }
}
