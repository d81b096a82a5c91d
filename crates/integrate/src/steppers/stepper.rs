//! [`Stepper`]: the run one step at a time.

use crate::control::frequency::Frequency;
use crate::control::make::{check_gradient, complete_step, make_step};
use crate::control::policy::SLOW;
use crate::error::IntegrateError;
use crate::options::common::Words;
use crate::options::method::Method;
use crate::report::certificate::Certificate;
use crate::report::defect::{Defect, Watched};
use crate::report::energy_floor::{EnergyFloor, kinetic_energy};
use crate::report::energy_jumps::EnergyJumps;
use crate::report::phase_per_step::PhasePerStep;
use crate::report::stopwatch::Stopwatch;
use crate::report::variable_steps::VariableSteps;
use crate::steppers::domains::WithinDomains;
use crate::steppers::grid::{Grid, is_same_time};
use crate::steppers::view::{Step, StepView};
use crate::time::direction::TimeDirection;
use crate::time::visible::visible;
use equip_scalar::Float;
use equip_solver::{Core, Counts, Outcome, Part, State};
use std::fmt;

/// Makes steps of the grid in parts where they are over switches of H.
pub(super) trait InParts<T: Float>: fmt::Debug + Send + Sync {
    /// Makes a step of size `h` that may still be refused.
    fn attempt(&mut self, run: &mut Stepper<T>, h: T) -> Result<Outcome, IntegrateError<T>>;

    /// The parts of the step made last, if it was made in several.
    fn parts(&self) -> Option<&[Part<T>]>;
}

/// A run that is made step by step: an endless iterator, or [`advance`](Self::advance) without copies.
#[derive(Debug)]
pub struct Stepper<T: Float> {
    pub(crate) core: Core<T>,
    /// Degrees of freedom, time not counted.
    pub(crate) m: usize,
    pub(super) method: Method,
    pub(super) has_target: bool,
    pub(crate) t0: T,
    /// Which way the run goes, and which way it goes when it begins.
    pub(crate) direction: TimeDirection,
    pub(super) first_direction: TimeDirection,
    /// Size of the steps; none if it varies.
    pub(super) size: Option<T>,
    /// Where the grid of time begins, and how many of its steps ahead of that, in the order of travel, the
    /// run is.
    pub(super) grid_start: T,
    pub(super) place: i64,
    /// The grid up to the end of the run, if that is known.
    pub(super) grid: Option<Grid<T>>,
    /// None if H has data everywhere as far as is known.
    pub(super) domains: Option<WithinDomains<T>>,
    /// None if H is smooth as far as is known, or the steps vary.
    pub(super) in_parts: Option<Box<dyn InParts<T>>>,
    /// Crossings of switches at which a step, or a part of one, ended.
    pub(crate) switches_crossed: u64,
    pub(crate) energy_jumps: Option<EnergyJumps<T>>,
    /// Room for ∇H.
    pub(super) slope: Vec<T>,
    pub(crate) h_ref: T,
    pub(crate) index: u64,
    pub(crate) time: T,
    pub(crate) y: State<T>,
    pub(super) next: State<T>,
    pub(super) measure_energy: bool,
    pub(crate) energy: Option<Defect<T>>,
    pub(crate) in_floors: Option<T>,
    pub(crate) energy_floor: Option<EnergyFloor<T>>,
    pub(crate) phase_per_step: Option<PhasePerStep<T>>,
    pub(super) frequency: Frequency<T>,
    /// Whether gradients written by hand are checked.
    pub(super) check_gradient: bool,
    pub(crate) watched: Vec<Watched<T>>,
    pub(crate) alpha_range: Vec<(T, T)>,
    pub(crate) last: (T, Outcome),
    pub(crate) floor: Option<T>,
    /// What a run with variable steps has to say about them.
    pub(crate) variable: Option<VariableSteps<T>>,
    pub(crate) begun: Stopwatch,
    /// Method and options, for checkpoints.
    pub(super) fingerprint: Words,
    /// (q, p) at the start of the run.
    pub(super) start: Vec<T>,
}

impl<T: Float> Stepper<T> {
    /// Turns the run round in time: the steps from here on go the other way.
    pub fn turn_back(&mut self) {
        self.direction = self.direction.turned();
        self.place = -self.place;
        self.grid = None;
    }

    /// Begins a new run at (`q0`, `p0`), each of length m, at time `t0`, with what this one has made ready:
    /// every bit is that of a run which has just been [started](crate::Integrator::start), and nothing is
    /// allocated. After an error the run is as it was.
    ///
    /// # Errors
    /// Faults of the initial values, and an H that is not finite there.
    pub fn restart(&mut self, q0: &[T], p0: &[T], t0: T) -> Result<(), IntegrateError<T>> {
        self.start_at((q0, p0), t0, None)
    }

    /// Puts the run at (`q`, `p`), each of length m, at the time it has reached, as after a kick: H and the
    /// invariants are kept at their values there from now on, and the next step is guessed from this state
    /// alone. Counts, grid and largest defects go on. Nothing is allocated; after an error nothing changes.
    ///
    /// # Errors
    /// Faults of the values, and an H that is not finite there.
    pub fn set_state(&mut self, q: &[T], p: &[T]) -> Result<(), IntegrateError<T>> {
        self.move_to(q, p, self.time)
    }

    /// The step of the grid, with its sign.
    pub(super) fn grid_step(&self) -> T {
        self.direction.signed(self.size.unwrap_or(T::int(0)))
    }

    /// Whether the run is at a point of its grid, within the rounding of time.
    pub(super) fn is_on_grid(&self) -> bool {
        self.is_at(self.grid_start + T::int(self.place) * self.grid_step())
    }

    /// Whether `t` is the time reached, within the rounding of the grid.
    pub(super) fn is_at(&self, t: T) -> bool {
        is_same_time(t, self.time, self.grid_start)
    }

    /// The grid begins anew at the time reached.
    pub(super) fn begin_grid(&mut self) {
        (self.grid_start, self.place) = (self.time, 0);
    }

    /// Whether the run has to turn back to come to `t`.
    ///
    /// # Errors
    /// A time that is not finite.
    pub(super) fn has_passed(&self, t: T) -> Result<bool, IntegrateError<T>> {
        if !t.is_finite() {
            let (start, end) = (self.time, t);
            return Err(IntegrateError::Interval { start, end });
        }
        Ok(self.direction.is_before(t, self.time))
    }

    /// Makes a step of size `h`, signed, that is taken to end at `time`.
    pub(super) fn make(&mut self, time: T, h: T) -> Result<(), IntegrateError<T>> {
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
    pub(super) fn attempt_in_parts(&mut self, h: T) -> Result<Outcome, IntegrateError<T>> {
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
        self.place += 1;
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
        self.floor = None;
        // Zero is in all of them from the beginning.
        if !self.core.alphas_are_zero() {
            for (range, &alpha) in self.alpha_range.iter_mut().zip(self.core.alphas()) {
                *range = (range.0.min(alpha), range.1.max(alpha));
            }
        }
        let elapsed = (self.time - self.t0).abs();
        let now = (self.time, self.last.0.abs() / elapsed);
        let seen = (self.energy_floor.as_mut()).filter(|_| outcome.energy_kept());
        if self.has_target {
            let residual = &self.core.constraints()[0];
            self.floor = Some(residual.floor());
            if let Some(energy) = &mut self.energy {
                energy.see(residual.defect());
            }
            if let Some(most) = &mut self.in_floors {
                *most = most.max(residual.in_late_floors());
            }
            if let Some(seen) = seen {
                let gradient = residual.gradient();
                seen.see(now, (residual.floor(), self.h_ref), || {
                    kinetic_energy(&self.y.hi, gradient, self.m)
                });
                seen.last = residual.momentary_floor();
            }
        } else if self.measure_energy {
            self.core.counts_mut().energies += 1;
            let value = self.core.energy_mut().compensated_value(&self.y.hi);
            let error = value - self.h_ref;
            if let Some(energy) = &mut self.energy {
                energy.see(error);
            }
            if let Some(seen) = seen {
                let slope = &mut self.slope;
                seen.see(now, (error.abs(), self.h_ref), || {
                    let (energy, counts) = self.core.energy_and_counts();
                    counts.gradients += 1;
                    energy.gradient(&self.y.hi, slope);
                    kinetic_energy(&self.y.hi, slope, self.m)
                });
            }
        }
        for watched in &mut self.watched {
            watched.see(self.time, &self.y.hi);
        }
    }

    /// The step made last, or the initial state.
    pub fn view(&self) -> StepView<'_, T> {
        let (q, p) = visible(&self.y.hi, self.m);
        StepView {
            index: self.index,
            time: self.time,
            step: self.last.0,
            q,
            p,
            energy_defect: self.energy.as_ref().map(|e| e.end),
            energy_floor: self.floor,
            alphas: self.core.alphas(),
            outcome: self.last.1,
            chaos: None,
        }
    }

    /// Time reached.
    pub fn time(&self) -> T {
        self.time
    }

    /// Counts so far.
    pub fn counts(&self) -> &Counts {
        self.core.counts()
    }

    fn mean_step(&self) -> T {
        let steps = i64::try_from(self.index).unwrap_or(i64::MAX);
        (self.time - self.t0) / T::int(steps.max(1))
    }

    /// The certificate of the run so far.
    pub fn certificate(&self) -> Certificate<T> {
        let certificate = Certificate {
            energy_conserved_to_round_off: String::new(),
            method: self.method,
            step: match self.size {
                Some(_) => self.grid_step(),
                None => self.mean_step(),
            },
            variable_steps: self.variable,
            switches_crossed: self.switches_crossed,
            energy_jumps: self.energy_jumps,
            start: self.t0,
            end: self.time,
            energy: self.energy.clone(),
            energy_in_floors: self.in_floors,
            energy_floor: self.energy_floor,
            phase_per_step: self.phase_per_step,
            invariants: self.watched.iter().map(|w| w.defect.clone()).collect(),
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

impl<T: Float> Iterator for Stepper<T> {
    type Item = Result<Step<T>, IntegrateError<T>>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(self.advance().map(|view| view.to_step()))
    }
}
