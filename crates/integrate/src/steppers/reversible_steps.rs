//! Reversible sizes: the stepper that makes them, and its checkpoints.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::exact::Exact;
use crate::checkpoints::memories::SwitchMemory;
use crate::control::step_density::StepDensity;
use crate::error::IntegrateError;
use crate::options::common::{Words, in_digits};
use crate::options::integrator::Integrator;
use crate::options::reversible::Symmetric;
use crate::report::variable_steps::VariableSteps;
use crate::steppers::reversible_stepper::ReversibleStepper;
use crate::steppers::sizes::{Advance, Sizes};
use crate::steppers::stepper::Stepper;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

impl<T: Float> Sizes<T> for Symmetric<T> {
    type Stepper = ReversibleStepper<T>;

    fn stepper(
        integrator: &Integrator<T, Self>,
        system: &Hamiltonian,
    ) -> Result<ReversibleStepper<T>, IntegrateError<T>> {
        let sizes = &integrator.sizes;
        sizes.validate()?;
        let inner = Stepper::prepare(integrator, system, None, integrator.words())?;
        let (n, stages) = (inner.y.hi.len(), inner.core.method().stages());
        Ok(ReversibleStepper {
            sigma: StepDensity::new(system, sizes.sigma.as_ref())?,
            rule: sizes.rule,
            epsilon: sizes.epsilon,
            density: T::int(0),
            time_low: T::int(0),
            end: None,
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
            ("epsilon", in_digits(self.epsilon)),
            ("sigma", sigma.to_owned()),
        ]
    }
}

impl<T: Float> Advance<T> for ReversibleStepper<T> {
    fn inner(&self) -> &Stepper<T> {
        &self.inner
    }

    fn inner_mut(&mut self) -> &mut Stepper<T> {
        &mut self.inner
    }

    fn begin(
        &mut self,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<(), IntegrateError<T>> {
        if t0.is_finite() {
            self.check_density(start, t0)?;
        }
        self.inner.start_at(start, t0, towards)?;
        (self.time_low, self.end) = (T::int(0), None);
        self.inner.variable = Some(VariableSteps::new(self.epsilon));
        self.begin_density()
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
        self.end = Some(end);
        Ok(())
    }

    fn kick(&mut self, state: (&[T], &[T]), t: T) -> Result<(), IntegrateError<T>> {
        self.check_density(state, t)?;
        self.inner.kick(state, t)?;
        self.time_low = T::int(0);
        self.begin_density()
    }

    fn is_done(&self) -> bool {
        let is_ahead = |end| self.inner.direction.is_before(self.inner.time(), end);
        self.end.is_some_and(|end| !is_ahead(end))
    }

    fn go_on(&mut self) -> Result<(), IntegrateError<T>> {
        self.advance_within(None).map(|_| ())
    }

    fn step(&mut self) -> Result<(), IntegrateError<T>> {
        self.advance_within(self.end).map(|_| ())
    }

    fn step_towards(&mut self, t: T) -> Result<bool, IntegrateError<T>> {
        if self.inner.has_passed(t)? {
            self.turn_back()?;
        }
        if t == self.time() {
            self.time_low = T::int(0);
            return Ok(false);
        }
        self.advance_within(Some(t))?;
        Ok(true)
    }

    fn time_low(&self) -> T {
        self.time_low
    }
}

impl<T: Float> ReversibleStepper<T> {
    /// Begins a new run at (`q0`, `p0`), each of length m, at time `t0`; see [`Stepper::restart`].
    ///
    /// # Errors
    /// Faults of the initial values, an H that is not finite there, and a σ that is not positive.
    pub fn restart(&mut self, q0: &[T], p0: &[T], t0: T) -> Result<(), IntegrateError<T>> {
        self.begin((q0, p0), t0, None)
    }

    /// The present state of the run, to be resumed by the same options.
    pub fn checkpoint(&mut self) -> Checkpoint {
        let next = Exact::of(self.density);
        self.inner
            .variable_checkpoint(self.time_low, (next, None), SwitchMemory::default())
    }
}
