//! Sizes by a tolerance: the stepper that makes them, and its checkpoints.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::exact::Exact;
use crate::control::controller::Control;
use crate::control::estimate::Decay;
use crate::control::first_step::FirstSize;
use crate::control::flow::Flow;
use crate::control::stuck::shortest_at;
use crate::error::IntegrateError;
use crate::events::crossings::Crossings;
use crate::options::adaptive::Tolerance;
use crate::options::common::{Words, in_digits};
use crate::options::integrator::Integrator;
use crate::report::variable_steps::VariableSteps;
use crate::steppers::adaptive::adaptive_stepper::AdaptiveStepper;
use crate::steppers::sizes::{Advance, Sizes};
use crate::steppers::stepper::Stepper;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;

impl<T: Float> Sizes<T> for Tolerance<T> {
    type Stepper = AdaptiveStepper<T>;

    fn stepper(
        integrator: &Integrator<T, Self>,
        system: &Hamiltonian,
    ) -> Result<AdaptiveStepper<T>, IntegrateError<T>> {
        let sizes = &integrator.sizes;
        sizes.validate(integrator.method)?;
        let mut inner = Stepper::prepare(integrator, system, None, integrator.words())?;
        let (n, most) = (inner.y.hi.len(), sizes.max_step.to_f64());
        let tolerance = sizes.tightest();
        let allowed = sizes.allowed(inner.m, n / 2)?;
        let crossings = Crossings::new(&system.switches(), inner.core.method(), n, tolerance);
        if crossings.is_some() {
            inner.core.defer_alphas();
        }
        Ok(AdaptiveStepper {
            crossings,
            control: Control::new(tolerance.to_f64(), integrator.method.degree(), most),
            decay: Decay::new(inner.core.method(), (n, inner.m), tolerance, allowed),
            flow: Flow::new(integrator.method.degree(), n),
            slope_rounding: vec![T::int(0); n],
            slopes: [(); 2].map(|()| vec![T::int(0); n]),
            first: FirstSize::new(n),
            first_step: sizes.first_step,
            longest_first: f64::INFINITY,
            tolerance,
            time_low: T::int(0),
            end: None,
            min_step: sizes.min_step,
            max_steps: sizes.max_steps,
            tries: None,
            inner,
        })
    }

    fn words(&self) -> Words {
        let or = |x: Option<T>, automatic: &str| x.map_or(automatic.to_owned(), in_digits);
        let errors = |x: &[T], otherwise: &str| match x {
            [] => otherwise.to_owned(),
            x => x
                .iter()
                .map(|&x| in_digits(x))
                .collect::<Vec<_>>()
                .join(", "),
        };
        vec![
            ("steps", "by a tolerance".to_owned()),
            ("tolerance", in_digits(self.tolerance)),
            ("rtol of the positions", errors(&self.relative[0], "that")),
            ("rtol of the momenta", errors(&self.relative[1], "that")),
            ("atol of the positions", errors(&self.absolute[0], "zero")),
            ("atol of the momenta", errors(&self.absolute[1], "zero")),
            ("first_step", or(self.first_step, "automatic")),
            ("min_step", in_digits(self.min_step)),
            ("max_step", in_digits(self.max_step)),
        ]
    }
}

impl<T: Float> AdaptiveStepper<T> {
    /// Begins a new run at (`q0`, `p0`), each of length m, at time `t0`; see [`Stepper::restart`].
    ///
    /// # Errors
    /// Faults of the initial values, and an H that is not finite there.
    pub fn restart(&mut self, q0: &[T], p0: &[T], t0: T) -> Result<(), IntegrateError<T>> {
        self.begin((q0, p0), t0, None)
    }

    /// The present state of the run, to be resumed by the same options.
    pub fn checkpoint(&mut self) -> Checkpoint {
        let switches = self.crossings.as_ref().map(Crossings::memory);
        let size = (Exact::of(self.control.next), self.tries);
        self.inner
            .variable_checkpoint(self.time_low, size, switches.unwrap_or_default())
    }
}

impl<T: Float> Advance<T> for AdaptiveStepper<T> {
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
        self.inner.start_at(start, t0, towards)?;
        self.take_slope();
        self.crossings.iter_mut().for_each(Crossings::begin);
        (self.time_low, self.end) = (T::int(0), None);
        let [first, longest] = match self.first_step {
            Some(h) => [h.to_f64(); 2],
            None => {
                let Stepper { core, y, .. } = &mut self.inner;
                self.first.sizes(core.energy_mut(), &y.hi)
            }
        };
        self.longest_first = longest;
        self.control.begin(first.max(shortest_at(t0).to_f64()));
        self.tries = self.first_step.is_none().then_some(0);
        self.inner.variable = Some(VariableSteps::new(self.tolerance));
        Ok(())
    }

    fn restore(&mut self, checkpoint: &Checkpoint) -> Result<(), IntegrateError<T>> {
        self.inner.restore_from(checkpoint)?;
        self.take_slope();
        let memory = checkpoint.control()?;
        self.time_low = checkpoint.time_low.read_finite("the time")?;
        let what = "the memory of step control";
        self.control.next = memory.next.read_finite::<T>(what)?.to_f64();
        self.tries = memory.tries;
        self.inner.variable = Some(memory.variable_steps(self.tolerance)?);
        let fits = match &mut self.crossings {
            Some(crossings) => crossings.restore(&memory.switches),
            None => memory.switches.sides.is_empty(),
        };
        if fits {
            Ok(())
        } else {
            Err(IntegrateError::CheckpointDamaged { what })
        }
    }

    fn save(&mut self) -> Checkpoint {
        self.checkpoint()
    }

    fn set_end(&mut self, end: T) -> Result<(), IntegrateError<T>> {
        self.end = Some(end);
        Ok(())
    }

    fn kick(&mut self, (q, p): (&[T], &[T]), t: T) -> Result<(), IntegrateError<T>> {
        self.inner.kick((q, p), t)?;
        self.time_low = T::int(0);
        self.take_slope();
        self.crossings.iter_mut().for_each(Crossings::begin);
        Ok(())
    }

    fn is_done(&self) -> bool {
        let is_ahead = |end| self.inner.direction.is_before(self.time(), end);
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
            self.turn_back();
        }
        if t == self.time() {
            self.time_low = T::int(0);
            return Ok(false);
        }
        let refused = |run: &Self| (run.inner.variable).map(|steps| steps.rejected + steps.failed);
        let (proposed, before) = (self.control.next, refused(self));
        self.advance_within(Some(t))?;
        // A step that was cut says nothing against the size that was proposed.
        if refused(self) == before && self.inner.last.0.abs().to_f64() < proposed {
            self.control.next = self.control.next.max(proposed);
        }
        Ok(true)
    }

    fn time_low(&self) -> T {
        self.time_low
    }
}
