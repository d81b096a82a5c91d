//! [`Integration`]: the state of a run and what is measured along it. It attempts steps of a given size and
//! takes them; step control chooses the sizes.

use crate::control::make::{check_gradient, complete_step, make_step};
use crate::error::IntegrateError;
use crate::options::common::Words;
use crate::options::method::Method;
use crate::report::certificate::Certificate;
use crate::report::measured::{LastStep, Measured};
use crate::report::stopwatch::Stopwatch;
use crate::steppers::domains::WithinDomains;
use crate::steppers::view::StepView;
use crate::time::direction::TimeDirection;
use crate::time::visible::visible;
use equip_scalar::Float;
use equip_solver::{Core, Counts, Outcome, Part, State};
use std::fmt;

/// Makes steps of the grid in parts where they are over switches of H.
pub(crate) trait InParts<T: Float>: fmt::Debug + Send + Sync {
    /// Makes a step of size `h` that may still be refused.
    fn attempt(&mut self, run: &mut Integration<T>, h: T) -> Result<Outcome, IntegrateError<T>>;

    /// The parts of the step made last, if it was made in several.
    fn parts(&self) -> Option<&[Part<T>]>;
}

/// State, references and measurements of a run.
#[derive(Debug)]
pub(crate) struct Integration<T: Float> {
    pub(crate) core: Core<T>,
    /// Degrees of freedom, time not counted.
    pub(crate) m: usize,
    pub(crate) method: Method,
    pub(crate) t0: T,
    /// Which way the run goes.
    pub(crate) direction: TimeDirection,
    /// Size of the steps, without a sign; none if it varies.
    pub(crate) size: Option<T>,
    /// None if H has data everywhere as far as is known.
    pub(crate) domains: Option<WithinDomains<T>>,
    /// None if H is smooth as far as is known, or the steps vary.
    pub(crate) in_parts: Option<Box<dyn InParts<T>>>,
    /// Room for ∇H.
    pub(crate) gradient: Vec<T>,
    pub(crate) h_ref: T,
    pub(crate) index: u64,
    pub(crate) time: T,
    pub(crate) y: State<T>,
    pub(crate) next: State<T>,
    pub(crate) measured: Measured<T>,
    /// Whether gradients written by hand are checked.
    pub(crate) check_gradient: bool,
    pub(crate) last: (T, Outcome),
    pub(crate) begun: Stopwatch,
    /// Method and options, for checkpoints.
    pub(crate) fingerprint: Words,
    /// (q, p) at the start of the run.
    pub(crate) start: Vec<T>,
}

impl<T: Float> Integration<T> {
    /// Whether the run has to turn back to come to `t`.
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

    /// Makes a step of size `h`, signed, that is taken to end at `time`.
    pub(crate) fn make(&mut self, time: T, h: T) -> Result<(), IntegrateError<T>> {
        if !self.direction.is_before(self.time, time) {
            return Err(IntegrateError::StepBelowTimeResolution {
                step: h,
                time: self.time,
            });
        }
        let outcome = self.attempt_in_parts(h)?;
        self.accept(time, h, outcome);
        Ok(())
    }

    /// Makes a step of the grid, of size `h`, in parts if it is over switches of H.
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

    /// The state after a step of size `h` from `y` at time `t`, which is no step of the run.
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

    /// What dense output needs of the step made last; empty unless something asks for it.
    pub(crate) fn parts(&self) -> &[Part<T>] {
        let in_parts = self.in_parts.as_ref().and_then(|in_parts| in_parts.parts());
        in_parts.unwrap_or(self.core.parts())
    }

    /// Makes a step of size `h` that may still be refused.
    pub(crate) fn attempt(&mut self, h: T) -> Result<Outcome, IntegrateError<T>> {
        if self.check_gradient && self.index.is_power_of_two() {
            check_gradient(self.core.energy_mut(), self.time, &self.y.hi)?;
        }
        let made = make_step(&mut self.core, (&self.y, self.time, h), &mut self.next);
        self.checked(h, made)
    }

    /// Finds the α_k of the step of size `h` made by [`attempt`](Self::attempt), where they were deferred.
    pub(crate) fn complete(&mut self, h: T) -> Result<Outcome, IntegrateError<T>> {
        let made = complete_step(&mut self.core, (&self.y, self.time, h), &mut self.next);
        self.checked(h, made)
    }

    /// A step that failed or was uncorrected, unless a gradient written by hand is to blame.
    fn checked(
        &mut self,
        h: T,
        made: Result<Outcome, IntegrateError<T>>,
    ) -> Result<Outcome, IntegrateError<T>> {
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

    /// Whether a gradient written by hand is that of H where the step begins that has failed, and where it
    /// had come to.
    fn check_gradient_of_failed(&mut self) -> Result<(), IntegrateError<T>> {
        let end = self.core.failed_end();
        let energy = self.core.energy_mut();
        check_gradient(energy, self.time, &self.y.hi)?;
        if end.iter().all(|x| x.is_finite()) {
            check_gradient(energy, self.time, &end)?;
        }
        Ok(())
    }

    /// Takes the step made by [`attempt`](Self::attempt), which ends at `time`.
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

    /// The step made last, or the initial state.
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

    /// Time reached.
    pub(crate) fn time(&self) -> T {
        self.time
    }

    /// Counts so far.
    pub(crate) fn counts(&self) -> &Counts {
        self.core.counts()
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
            variable_steps: measured.variable,
            switches_crossed: measured.switches_crossed,
            energy_jumps: measured.energy_jumps,
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
