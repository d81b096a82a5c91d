//! [`Integration`]: the state of a run and what is measured along it. It attempts steps of a given size and
//! takes them; [`crate::steppers::step_control`] chooses the sizes.

use crate::control::frequency::Frequency;
use crate::control::make::{check_gradient, complete_step, make_step};
use crate::control::policy::SLOW;
use crate::error::IntegrateError;
use crate::options::common::Words;
use crate::options::method::Method;
use crate::report::certificate::Certificate;
use crate::report::conserved::{Conserved, Watched};
use crate::report::energy_jumps::EnergyJumps;
use crate::report::energy_round_off::{EnergyRoundOff, kinetic_energy};
use crate::report::phase_per_step::PhasePerStep;
use crate::report::stopwatch::Stopwatch;
use crate::report::variable_steps::VariableSteps;
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
    pub(crate) has_target: bool,
    pub(crate) t0: T,
    /// Which way the run goes.
    pub(crate) direction: TimeDirection,
    /// Size of the steps, without a sign; none if it varies.
    pub(crate) size: Option<T>,
    /// None if H has data everywhere as far as is known.
    pub(crate) domains: Option<WithinDomains<T>>,
    /// None if H is smooth as far as is known, or the steps vary.
    pub(crate) in_parts: Option<Box<dyn InParts<T>>>,
    /// Crossings of switches at which a step, or a part of one, ended.
    pub(crate) switches_crossed: u64,
    pub(crate) energy_jumps: Option<EnergyJumps<T>>,
    /// Room for ∇H.
    pub(crate) gradient: Vec<T>,
    pub(crate) h_ref: T,
    pub(crate) index: u64,
    pub(crate) time: T,
    pub(crate) y: State<T>,
    pub(crate) next: State<T>,
    pub(crate) measure_energy: bool,
    pub(crate) energy: Option<Conserved<T>>,
    pub(crate) in_levels: Option<T>,
    pub(crate) energy_round_off: Option<EnergyRoundOff<T>>,
    pub(crate) phase_per_step: Option<PhasePerStep<T>>,
    pub(crate) frequency: Frequency<T>,
    /// Whether gradients written by hand are checked.
    pub(crate) check_gradient: bool,
    pub(crate) watched: Vec<Watched<T>>,
    pub(crate) alpha_range: Vec<(T, T)>,
    pub(crate) last: (T, Outcome),
    pub(crate) round_off: Option<T>,
    /// What a run with variable steps has to say about them.
    pub(crate) variable: Option<VariableSteps<T>>,
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

    /// A step, or a part of one, has ended on `count` switches, where H jumps by so much.
    pub(crate) fn cross(&mut self, count: u64, jump: Option<T>) {
        self.switches_crossed += count;
        if let Some(jump) = jump {
            self.energy_jumps = Some(EnergyJumps::after(self.energy_jumps, jump));
        }
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
            let (time, energy) = (self.time, self.core.energy_mut());
            let checked = match made {
                Ok(outcome) if outcome.is_uncorrected() => {
                    check_gradient(energy, time + h, &self.next.hi)
                }
                Err(_) => check_gradient(energy, time, &self.y.hi),
                Ok(_) => Ok(()),
            };
            if let Err(wrong) = checked {
                self.core.refuse();
                return Err(wrong);
            }
        }
        made
    }

    /// Takes the step made by [`attempt`](Self::attempt), which ends at `time`.
    pub(crate) fn accept(&mut self, time: T, h: T, outcome: Outcome) {
        std::mem::swap(&mut self.y, &mut self.next);
        self.index += 1;
        self.time = time;
        self.last = (h, outcome);
        self.core.counts_mut().record(outcome);
        self.measure(outcome);
        if self.index.is_power_of_two() {
            self.measure_phase(h);
        }
    }

    /// hω of the step just made, unless its iteration contracted without ∇²H as it does where hω is small.
    fn measure_phase(&mut self, h: T) {
        let is_slow = self.core.contraction().is_some_and(|rate| rate > SLOW);
        if !is_slow && !self.core.is_preconditioned() {
            return;
        }
        let step = h.abs();
        let omega = self.frequency.at(self.core.energy_mut(), &self.y.hi);
        let angle = omega * step.to_f64();
        let phase = PhasePerStep { angle, step };
        self.phase_per_step = Some(phase.max(self.phase_per_step));
    }

    /// Energy, invariants and α_k of the step just made.
    fn measure(&mut self, outcome: Outcome) {
        self.round_off = None;
        // Zero is in all of them from the beginning.
        if !self.core.alphas_are_zero() {
            for (range, &alpha) in self.alpha_range.iter_mut().zip(self.core.alphas()) {
                *range = (range.0.min(alpha), range.1.max(alpha));
            }
        }
        let elapsed = (self.time - self.t0).abs();
        let now = (self.time, self.last.0.abs() / elapsed);
        let seen = (self.energy_round_off.as_mut()).filter(|_| outcome.energy_kept());
        if self.has_target {
            let constraint = &self.core.constraints()[0];
            self.round_off = Some(constraint.round_off());
            if let Some(energy) = &mut self.energy {
                energy.see(constraint.residual());
            }
            if let Some(most) = &mut self.in_levels {
                *most = most.max(constraint.in_late_levels());
            }
            if let Some(seen) = seen {
                let gradient = constraint.gradient();
                seen.see(now, (constraint.round_off(), self.h_ref), || {
                    kinetic_energy(&self.y.hi, gradient, self.m)
                });
                seen.last = constraint.momentary_round_off();
            }
        } else if self.measure_energy {
            self.core.counts_mut().energies += 1;
            let value = self.core.energy_mut().compensated_value(&self.y.hi);
            let error = value - self.h_ref;
            if let Some(energy) = &mut self.energy {
                energy.see(error);
            }
            if let Some(seen) = seen {
                let gradient = &mut self.gradient;
                seen.see(now, (error.abs(), self.h_ref), || {
                    let (energy, counts) = self.core.energy_and_counts();
                    counts.gradients += 1;
                    energy.gradient(&self.y.hi, gradient);
                    kinetic_energy(&self.y.hi, gradient, self.m)
                });
            }
        }
        for watched in &mut self.watched {
            watched.see(self.time, &self.y.hi);
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
            energy_error: self.energy.as_ref().map(|e| e.end),
            energy_round_off: self.round_off,
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
        let certificate = Certificate {
            energy_conserved_to_round_off: String::new(),
            method: self.method,
            step: match self.size {
                Some(h) => self.direction.signed(h),
                None => self.mean_step(),
            },
            variable_steps: self.variable,
            switches_crossed: self.switches_crossed,
            energy_jumps: self.energy_jumps,
            start: self.t0,
            end: self.time,
            energy: self.energy.clone(),
            energy_in_round_off_levels: self.in_levels,
            energy_round_off: self.energy_round_off,
            phase_per_step: self.phase_per_step,
            invariants: self.watched.iter().map(|w| w.conserved.clone()).collect(),
            alpha_range: self.alpha_range.clone(),
            chaos: None,
            counts: *self.core.counts(),
            output_steps: 0,
            coarse_outputs: 0,
            seconds: self.begun.seconds(),
        };
        certificate.judged()
    }
}
