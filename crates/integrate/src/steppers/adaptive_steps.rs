//! Sizes by a tolerance: the stepper that makes them, and its checkpoints.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::exact::Exact;
use crate::control::controller::{Control, Memory};
use crate::control::estimate::Decay;
use crate::control::first_step::FirstSize;
use crate::error::IntegrateError;
use crate::options::adaptive::Tolerance;
use crate::options::common::Words;
use crate::options::integrator::Integrator;
use crate::steppers::adaptive_stepper::{AdaptiveStepper, TRIES_FOR_FIRST};
use crate::steppers::sizes::{Advance, StepSizes};
use crate::steppers::stepper::Stepper;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;

impl<T: Float> StepSizes<T> for Tolerance<T> {
    type Stepper<E: Evaluate<T>> = AdaptiveStepper<T, E>;

    fn stepper<H: System>(
        integrator: &Integrator<T, Self>,
        system: &H,
    ) -> Result<AdaptiveStepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        let sizes = &integrator.sizes;
        sizes.validate(integrator.method.stages)?;
        let inner = Stepper::prepare(integrator, system, None, integrator.words())?;
        let (n, most) = (inner.y.hi.len(), sizes.max_step.to_f64());
        let tolerance = sizes.tolerance.to_f64();
        let absolute = sizes.absolute_errors(n / 2)?;
        Ok(AdaptiveStepper {
            control: Control::new(tolerance, integrator.method.stages, most),
            decay: Decay::new(inner.core.gauss(), n, sizes.tolerance, absolute),
            slopes: [(); 2].map(|()| vec![T::int(0); n]),
            first: FirstSize::new(n),
            first_step: sizes.first_step,
            longest_first: f64::INFINITY,
            tolerance: sizes.tolerance,
            time_low: T::int(0),
            end: None,
            min_step: sizes.min_step,
            max_steps: sizes.max_steps,
            tries: TRIES_FOR_FIRST,
            inner,
        })
    }

    fn words(&self) -> Words {
        let or =
            |x: Option<T>, automatic: &str| x.map_or(automatic.to_owned(), |x| format!("{x:?}"));
        let errors = |x: &[T]| match x {
            [] => "zero".to_owned(),
            x => format!("{x:?}"),
        };
        vec![
            ("steps", "by a tolerance".to_owned()),
            ("tolerance", format!("{:?}", self.tolerance)),
            ("atol of the positions", errors(&self.absolute[0])),
            ("atol of the momenta", errors(&self.absolute[1])),
            ("first_step", or(self.first_step, "automatic")),
            ("min_step", format!("{:?}", self.min_step)),
            ("max_step", format!("{:?}", self.max_step)),
        ]
    }
}

impl<T: Float, E: Evaluate<T>> AdaptiveStepper<T, E> {
    /// The present state of the run, to be resumed by the same options.
    pub fn checkpoint(&mut self) -> Checkpoint {
        let Memory { next } = self.control.memory;
        self.inner
            .variable_checkpoint(self.time_low, Exact::of(next), self.tries)
    }
}

impl<T: Float, E: Evaluate<T>> Advance<T, E> for AdaptiveStepper<T, E> {
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
        self.take_slope();
        let memory = checkpoint.control()?;
        self.time_low = checkpoint.time_low.read_finite("the time")?;
        let what = "the memory of step control";
        let float = |x: &Exact| x.read_finite::<T>(what).map(Float::to_f64);
        self.control.memory = Memory {
            next: float(&memory.next)?,
        };
        self.tries = memory.tries;
        self.inner.variable = Some(memory.variable_steps(self.tolerance)?);
        Ok(())
    }

    fn save(&mut self) -> Checkpoint {
        self.checkpoint()
    }

    fn set_end(&mut self, end: T) -> Result<(), IntegrateError<T>> {
        self.end = Some(end);
        Ok(())
    }

    fn is_done(&self) -> bool {
        self.end.is_some_and(|end| !(self.time() < end))
    }

    fn step(&mut self) -> Result<(), IntegrateError<T>> {
        self.advance_within(self.end).map(|_| ())
    }

    fn time_low(&self) -> T {
        self.time_low
    }
}
