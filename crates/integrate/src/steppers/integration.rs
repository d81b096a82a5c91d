//! [`Integration`]: the state of a run and its measurements. It attempts and accepts steps of a given size;
//! step control chooses the sizes.

use crate::control::failed::{check_gradient, error_of};
use crate::error::IntegrateError;
use crate::options::common::Words;
use crate::options::method::Method;
use crate::report::certificate::Certificate;
use crate::report::entries::VariableSteps;
use crate::report::measured::{LastStep, Measured};
use crate::report::stopwatch::Stopwatch;
use crate::steppers::domains::WithinDomains;
use crate::steppers::view::StepView;
use crate::time::direction::TimeDirection;
use crate::time::visible::visible;
use equip_scalar::Float;
use equip_solver::{Core, Failure, Outcome, Part, State};
use std::fmt;

/// Splits steps of the grid that cross switches of H.
pub(crate) trait InParts<T: Float>: fmt::Debug + Send + Sync {
    /// Attempts a step of size `h`, which may still be rejected.
    fn attempt(&mut self, run: &mut Integration<T>, h: T) -> Result<Outcome, IntegrateError<T>>;

    /// The parts of the last step, if it was split.
    fn parts(&self) -> Option<&[Part<T>]>;
}

/// The state, references and measurements of a run.
#[derive(Debug)]
pub(crate) struct Integration<T: Float> {
    pub(crate) core: Core<T>,
    /// The degrees of freedom, without time.
    pub(crate) m: usize,
    pub(crate) method: Method,
    pub(crate) t0: T,
    /// The direction of the run.
    pub(crate) direction: TimeDirection,
    /// The size of the steps, without sign; `None` if it varies.
    pub(crate) size: Option<T>,
    /// `None` if H is defined everywhere, as far as is known.
    pub(crate) domains: Option<WithinDomains<T>>,
    /// `None` if H is smooth, as far as is known, or if the steps vary.
    pub(crate) in_parts: Option<Box<dyn InParts<T>>>,
    /// Workspace for ∇H.
    pub(crate) gradient: Vec<T>,
    pub(crate) h_ref: T,
    pub(crate) index: u64,
    pub(crate) time: T,
    pub(crate) y: State<T>,
    pub(crate) next: State<T>,
    pub(crate) measured: Measured<T>,
    /// Whether user-supplied gradients are checked.
    pub(crate) check_gradient: bool,
    pub(crate) last: (T, Outcome),
    pub(crate) begun: Stopwatch,
    /// Method and options, for checkpoints.
    pub(crate) fingerprint: Words,
    /// (q, p) at the start of the run.
    pub(crate) start: Vec<T>,
}

impl<T: Float> Integration<T> {
    /// Whether the run must reverse its direction to reach `t`.
    ///
    /// # Errors
    /// A time that is not finite.
    pub(crate) fn has_passed(&self, t: T) -> Result<bool, IntegrateError<T>> {
        if !t.is_finite() {
            let (start, end) = (self.time, t);
            return Err(IntegrateError::Interval { start, end });
        }
        Ok(self.direction.is_before(t, self.time))
    }

    /// Attempts a step of the grid, of size `h`, in parts if it crosses switches of H.
    pub(crate) fn attempt_in_parts(&mut self, h: T) -> Result<Outcome, IntegrateError<T>> {
        let Some(mut in_parts) = self.in_parts.take() else {
            let outcome = self.attempt(h)?;
            self.check_domains(h)?;
            return Ok(outcome);
        };
        let made = in_parts.attempt(self, h);
        self.in_parts = Some(in_parts);
        made
    }

    /// The state after a step of size `h` from `y` at time `t`. The step does not belong to the run.
    pub(crate) fn aside(
        &mut self,
        (y, t): (&State<T>, T),
        h: T,
    ) -> Result<&[T], IntegrateError<T>> {
        self.y.copy_from(y);
        self.time = t;
        self.attempt_in_parts(h)?;
        Ok(&self.next.hi)
    }

    /// The data of the last step for dense output; empty unless requested.
    pub(crate) fn parts(&self) -> &[Part<T>] {
        let in_parts = self.in_parts.as_ref().and_then(|in_parts| in_parts.parts());
        in_parts.unwrap_or(self.core.parts())
    }

    /// The same parts, each with the state at its end.
    pub(crate) fn parts_to_ends(&self) -> impl Iterator<Item = (&Part<T>, &State<T>)> {
        let starts = self.parts().iter().map(|part| &part.start);
        (self.parts().iter()).zip(starts.skip(1).chain(std::iter::once(&self.y)))
    }

    /// The times at the ends of these parts.
    pub(crate) fn times_of_ends(&self) -> impl Iterator<Item = T> {
        let starts = self.parts().iter().map(|part| part.time);
        starts.skip(1).chain(std::iter::once(self.time))
    }

    /// Attempts a step of size `h`, which may still be rejected.
    pub(crate) fn attempt(&mut self, h: T) -> Result<Outcome, IntegrateError<T>> {
        if self.check_gradient && self.index.is_power_of_two() {
            check_gradient(self.core.energy_mut(), self.time, &self.y.hi)?;
        }
        let made = self.core.step(&self.y, self.time, h, &mut self.next);
        self.checked(h, made)
    }

    /// Computes the α_k of the step of size `h` from [`attempt`](Self::attempt), if they were deferred.
    pub(crate) fn complete(&mut self, h: T) -> Result<Outcome, IntegrateError<T>> {
        let made = self.core.complete(&self.y, self.time, h, &mut self.next);
        self.checked(h, made)
    }

    /// Checks a user-supplied gradient if the step failed or is uncorrected.
    fn checked(
        &mut self,
        h: T,
        made: Result<Outcome, Failure<T>>,
    ) -> Result<Outcome, IntegrateError<T>> {
        let mut made = made.map_err(|failure| error_of(&mut self.core, failure));
        // H and ∇H may be finite at a state that is not.
        if made.is_ok() && !self.next.hi.iter().all(|y| y.is_finite()) {
            self.core.refuse();
            let (time, step, halvings) = (self.time, h, 0);
            made = Err(IntegrateError::NotFinite {
                time,
                step,
                halvings,
            });
        }
        if self.check_gradient {
            let checked = match made {
                Ok(outcome) if outcome.is_uncorrected() => {
                    check_gradient(self.core.energy_mut(), self.time + h, &self.next.hi)
                }
                Err(_) => self.check_gradient_of_failed(),
                Ok(_) => Ok(()),
            };
            if let Err(wrong) = checked {
                self.core.refuse();
                return Err(wrong);
            }
        }
        made
    }

    /// Checks a user-supplied gradient at the start of the failed step, and at its last iterate.
    fn check_gradient_of_failed(&mut self) -> Result<(), IntegrateError<T>> {
        let end = self.core.failed_end();
        let energy = self.core.energy_mut();
        check_gradient(energy, self.time, &self.y.hi)?;
        if end.iter().all(|x| x.is_finite()) {
            check_gradient(energy, self.time, &end)?;
        }
        Ok(())
    }

    /// Accepts the step of [`attempt`](Self::attempt), which ends at `time`.
    pub(crate) fn accept(&mut self, time: T, h: T, outcome: Outcome) {
        std::mem::swap(&mut self.y, &mut self.next);
        self.index += 1;
        self.time = time;
        self.last = (h, outcome);
        self.core.counts_mut().record(outcome);
        let Integration { core, measured, .. } = self;
        let last = LastStep {
            y: &self.y.hi,
            m: self.m,
            time,
            h,
            elapsed: (time - self.t0).abs(),
            outcome,
            h_ref: self.h_ref,
        };
        measured.see(core, &last, &mut self.gradient);
        if self.index.is_power_of_two() {
            measured.see_phase(core, &self.y.hi, h);
        }
    }

    /// The last step, or the initial state.
    pub(crate) fn view(&self) -> StepView<'_, T> {
        let (q, p) = visible(&self.y.hi, self.m);
        StepView {
            index: self.index,
            time: self.time,
            step: self.last.0,
            q,
            p,
            energy_error: self.measured.energy.as_ref().map(|e| e.end),
            energy_round_off: self.measured.round_off,
            alphas: self.core.alphas(),
            outcome: self.last.1,
            chaos: None,
        }
    }

    fn mean_step(&self) -> T {
        let steps = i64::try_from(self.index).unwrap_or(i64::MAX);
        (self.time - self.t0) / T::int(steps.max(1))
    }

    /// The certificate of the run so far.
    pub(crate) fn certificate(&self) -> Certificate<T> {
        let measured = &self.measured;
        let certificate = Certificate {
            energy_conserved_to_round_off: String::new(),
            method: self.method,
            step: match self.size {
                Some(h) => self.direction.signed(h),
                None => self.mean_step(),
            },
            variable_steps: measured.variable.map(VariableSteps::of_steps),
            discontinuities_crossed: measured.discontinuities_crossed,
            energy_jumps: measured.energy_jumps,
            state_changes: measured.state_changes.0,
            start: self.t0,
            end: self.time,
            energy: measured.energy.clone(),
            energy_in_round_off_levels: measured.in_levels,
            energy_round_off: measured.energy_round_off,
            phase_per_step: measured.phase_per_step,
            invariants: measured
                .watched
                .iter()
                .map(|w| w.conserved.clone())
                .collect(),
            alpha_range: measured.alpha_range.clone(),
            chaos: None,
            counts: *self.core.counts(),
            output_steps: 0,
            coarse_outputs: 0,
            seconds: self.begun.seconds(),
        };
        certificate.judged()
    }
}
