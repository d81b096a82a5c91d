//! Runs by a tolerance: start, end, reversal and resumption.

use crate::checkpoints::memory::Memory;
use crate::control::controller::Control;
use crate::control::estimate::Decay;
use crate::control::first_step::FirstSize;
use crate::control::flow::Flow;
use crate::control::policy::LONGEST_SINCE;
use crate::control::stuck::shortest_at;
use crate::error::IntegrateError;
use crate::events::crossings::Crossings;
use crate::options::method::Method;
use crate::options::tolerance::Tolerance;
use crate::report::entries::VariableSteps;
use crate::steppers::integration::Integration;
use crate::steppers::sizes::adaptive_steps::AdaptiveSteps;
use crate::steppers::step_control::{StepControl, way};
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use std::slice::from_mut;

impl<T: Float> AdaptiveSteps<T> {
    pub(super) fn new(
        sizes: &Tolerance<T>,
        method: Method,
        system: &Hamiltonian,
        run: &mut Integration<T>,
    ) -> Result<Self, IntegrateError<T>> {
        let (n, most) = (run.y.hi.len(), sizes.max_step.to_f64());
        let tolerance = sizes.tightest();
        let allowed = sizes.allowed(run.m, n / 2)?;
        let crossings = Crossings::new(&system.switches(), run.core.method(), n, tolerance);
        if crossings.is_some() {
            run.core.defer_alphas();
        }
        Ok(AdaptiveSteps {
            // An external energy has no trace.
            is_smooth: crossings.is_none() && system.operations() > 0,
            crossings,
            control: Control::new(tolerance.to_f64(), method.degree(), most),
            decay: Decay::new(run.core.method(), (n, run.m), tolerance, allowed),
            flow: Flow::new(method.degree(), n),
            gradient_rounding: vec![T::int(0); n],
            products: [(); 2].map(|()| vec![T::int(0); n]),
            gradients: [(); 2].map(|()| vec![T::int(0); n]),
            first: FirstSize::new(n),
            first_step: sizes.first_step,
            longest_first: f64::INFINITY,
            tolerance,
            time_low: T::int(0),
            end: None,
            min_step: sizes.min_step,
            max_steps: sizes.max_steps,
            tries: None,
        })
    }
}

impl<T: Float> StepControl<T> for AdaptiveSteps<T> {
    fn begin(
        &mut self,
        run: &mut Integration<T>,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<(), IntegrateError<T>> {
        let direction = way(t0, towards)?.unwrap_or_default();
        run.start_at(start, t0, direction)?;
        self.at_another_state(run);
        (self.time_low, self.end) = (T::int(0), None);
        let [first, longest] = match self.first_step {
            Some(h) => [h.to_f64(); 2],
            None => self.first.sizes(run.core.energy_mut(), &run.y.hi),
        };
        self.longest_first = longest;
        self.control.begin(first.max(shortest_at(t0).to_f64()));
        self.tries = self.first_step.is_none().then_some(0);
        run.measured.variable = Some(VariableSteps::new(self.tolerance));
        Ok(())
    }

    fn remember(&mut self, run: &mut Integration<T>, memory: &mut Memory<'_>) {
        let name = "the rounding remainder of the time";
        memory.finite(name, from_mut(&mut self.time_low));
        memory.check_that(self.time_low.abs() <= T::EPSILON * run.time.abs(), name);
        let mut next = T::exact(self.control.next);
        memory.finite("the next step", from_mut(&mut next));
        self.control.next = next.to_f64();
        let tries = self.tries.map(|tries| T::int(tries.into()));
        let tries = memory.one("the attempts of the first step", tries);
        self.tries = tries.map(|tries| tries.to_f64() as u32);
        if let Some(steps) = &mut run.measured.variable {
            let mut sizes = [steps.smallest, steps.largest];
            memory.any("the sizes of the steps", &mut sizes);
            [steps.smallest, steps.largest] = sizes;
            for count in [&mut steps.rejected, &mut steps.failed] {
                *count = memory.count::<T>("the steps not accepted", *count);
            }
        }
        if let Some(crossings) = &mut self.crossings {
            crossings.remember(memory);
        }
    }

    fn set_end(&mut self, _: &Integration<T>, end: T) -> Result<(), IntegrateError<T>> {
        self.end = Some(end);
        Ok(())
    }

    fn is_done(&self, run: &Integration<T>) -> bool {
        let is_ahead = |end| run.direction.is_before(run.time, end);
        self.end.is_some_and(|end| !is_ahead(end))
    }

    fn at_another_state(&mut self, run: &mut Integration<T>) {
        self.take_gradient(run);
        self.crossings.iter_mut().for_each(Crossings::begin);
    }

    /// The next step is at most [`LONGEST_SINCE`] of the time between the last two changes. Where one step
    /// integrates the motion exactly, steps would become ever longer, and a root has the rounding error of
    /// the complete step (docs/adr/0033).
    fn at_another_time(
        &mut self,
        run: &mut Integration<T>,
        since: T,
    ) -> Result<(), IntegrateError<T>> {
        self.time_low = T::int(0);
        if since > T::int(0) {
            self.control.next = self.control.next.min(LONGEST_SINCE * since.to_f64());
        }
        self.at_another_state(run);
        Ok(())
    }

    fn turn_back(&mut self, run: &mut Integration<T>) {
        run.direction = run.direction.turned();
        self.end = None;
        if let Some(crossings) = &mut self.crossings {
            crossings.turn_back();
        }
    }

    fn step(&mut self, run: &mut Integration<T>, meets_end: bool) -> Result<(), IntegrateError<T>> {
        self.advance_within(run, self.end.filter(|_| meets_end))
    }

    fn step_towards(&mut self, run: &mut Integration<T>, t: T) -> Result<bool, IntegrateError<T>> {
        if run.has_passed(t)? {
            self.turn_back(run);
        }
        if t == run.time {
            self.time_low = T::int(0);
            return Ok(false);
        }
        let refused = |run: &Integration<T>| {
            run.measured
                .variable
                .map(|steps| steps.rejected + steps.failed)
        };
        let (proposed, before) = (self.control.next, refused(run));
        self.advance_within(run, Some(t))?;
        // A step that was shortened to meet `t` does not reduce the proposed size.
        if refused(run) == before && run.last.0.abs().to_f64() < proposed {
            self.control.next = self.control.next.max(proposed);
        }
        Ok(true)
    }

    fn time_low(&self) -> T {
        self.time_low
    }

    fn next_step(&self) -> T {
        T::exact(self.control.next)
    }

    fn next_time(&self) -> Option<T> {
        None
    }
}
