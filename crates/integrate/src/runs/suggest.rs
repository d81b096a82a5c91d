//! Suggestions for a fixed step, from the second derivatives of H at the start and from trial runs.
//!
//! *Phase.* The phase of the fastest motion at the start is hω per step, with ω from
//! [`crate::control::frequency`].
//!
//! *Target.* With order 2s errors are proportional to h^{2s}. A trial with n steps over the interval has the
//! error e, measured against a trial with 2n steps. Then
//!
//! $$ n^+ = n \Big( \frac{e}{\mathrm{target}} \Big)^{1/(2s)} $$
//!
//! steps would meet the target. The search starts with a phase of s/4 and continues until a trial has met the
//! target, usually the third. The returned step was tried, not extrapolated.
//!
//! Cost: for each trial 3n steps for a trajectory, n for the energy. The interval should contain the typical
//! motion, for example one period.

use crate::control::frequency::Frequency;
use crate::control::policy::{GOOD_ENOUGH, MOST_TRIES, SAFETY};
use crate::error::IntegrateError;
use crate::options::integrator::{Integrator, StepSizes};
use crate::options::method::Gauss;
use crate::options::method::Method;
use crate::options::record::Record;
use crate::runs::observer::{NoObserver, Observer};
use crate::runs::run::{Run, RunFailure};
use crate::steppers::view::StepView;
use equip_autodiff::Hamiltonian;
use equip_scalar::Float;
use equip_scalar::power::power;
use equip_solver::Family;
use std::ops::RangeInclusive;

/// The maximum number of steps of a trial, and of numbers in its states.
const MOST_STEPS: f64 = 1e6;
const MOST_NUMBERS: f64 = 5e7;

/// The goal of a suggested step.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Target<T> {
    /// The phase of the fastest motion at the start per step; 6.3 is a complete revolution. No trials are
    /// run.
    Phase(T),
    /// The largest error of a position or momentum within the interval, in their units.
    Trajectory(T),
    /// The largest |H − H_ref| within the interval for the *Gauss* method with the same number of stages: the
    /// energy error that the α_k of EQUIP must remove.
    Energy(T),
}

impl Method {
    /// A fixed step for this method that reaches `target` from (`q0`, `p0`) over `interval`, and divides the
    /// interval. The step has no sign.
    ///
    /// ```
    /// use equip_autodiff::Hamiltonian;
    /// use equip_integrate::{Equip, Target};
    ///
    /// let pendulum = Hamiltonian::new(1, |q, p| 0.5 * p[0] * p[0] - q[0].cos())?;
    /// let method = Equip::stages(4);
    /// let h = method.suggest_step(&pendulum, &[0.0], &[1.5], 0.0..=10.0, Target::Trajectory(1e-9))?;
    /// let run = method.step(h).integrate(&pendulum, &[0.0], &[1.5], 0.0..=10.0)?;
    /// assert!(h > 0.05 && run.certificate().energy_conserved_on_every_step());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error for a target that is not positive, a target below the round-off errors
    /// ([`IntegrateError::TargetBelowRoundOff`]), a target that no trial of reasonable length reaches
    /// ([`IntegrateError::TargetNotReached`]), a phase although the second derivatives of H vanish, and the
    /// errors of the start.
    pub fn suggest_step<T: Float>(
        self,
        system: &Hamiltonian,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
        target: Target<T>,
    ) -> Result<T, IntegrateError<T>> {
        let observer = &mut NoObserver;
        self.suggest_step_observed(system, q0, p0, interval, target, observer)
    }

    /// The same with an observer, which sees every step of every trial and may end the search. The result is
    /// then the longest step that has met the target so far, or the step of the last trial.
    ///
    /// # Errors
    /// The errors of [`suggest_step`](Self::suggest_step).
    pub fn suggest_step_observed<T: Float>(
        self,
        system: &Hamiltonian,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
        target: Target<T>,
        observer: &mut impl Observer<T>,
    ) -> Result<T, IntegrateError<T>> {
        let (t0, t1) = interval.clone().into_inner();
        let length = (t1 - t0).abs();
        // Checks options, interval and initial state.
        let options = self.step(length);
        options.options.check_times(t0, t1)?;
        let start = options.start(system, q0, p0, t0)?.inner.y.hi;
        let (name, value) = match target {
            Target::Phase(x) => ("phase", x),
            Target::Trajectory(x) => ("target error", x),
            Target::Energy(x) => ("target energy", x),
        };
        let refused = |value, expected| IntegrateError::Option {
            option: name,
            value,
            expected,
        };
        if !(value > T::int(0)) || !value.is_finite() {
            return Err(refused(value, "positive and finite"));
        }
        let pace = Frequency::new(system).at(&mut system.evaluator::<T>(), &start);
        let pace = T::exact(pace);
        if let Target::Phase(phase) = target {
            return if pace > T::int(0) && pace.is_finite() {
                Ok((phase / pace).min(length))
            } else {
                Err(refused(
                    phase,
                    "omitted if the second derivatives of H vanish at the initial state; give a target error",
                ))
            };
        }
        let mut trials = Trials {
            method: self,
            system,
            start: (q0, p0),
            interval,
            length,
            target,
            observer,
            is_ended: false,
        };
        let phase = T::ratio(self.degree() as i64, 4);
        let steps = (length * pace / phase).to_f64();
        trials.search(value, if steps.is_finite() { steps } else { 1.0 })
    }
}

/// The search for a number of steps.
struct Trials<'a, T: Float, O> {
    method: Method,
    system: &'a Hamiltonian,
    start: (&'a [T], &'a [T]),
    interval: RangeInclusive<T>,
    length: T,
    target: Target<T>,
    observer: &'a mut O,
    /// Whether the observer has ended the search.
    is_ended: bool,
}

impl<T: Float, O: Observer<T>> Trials<'_, T, O> {
    fn search(&mut self, target: T, first: f64) -> Result<T, IntegrateError<T>> {
        let order = 2.0 * self.method.degree() as f64;
        let (q, p) = self.start;
        let most = MOST_STEPS.min(MOST_NUMBERS / (q.len() + p.len()) as f64);
        // Errors above the square root of rounding are not attributed to rounding.
        let size = (q.iter().chain(p)).fold(T::int(0), |size, x| size.max(x.abs()));
        let small = T::EPSILON.sqrt() * size.max(target);
        let mut steps = first.clamp(1.0, (most / 4.0).max(1.0)).ceil();
        // The largest number of steps that was too small, and the smallest one that was sufficient.
        let (mut few, mut enough): (f64, Option<f64>) = (0.0, None);
        let mut least: Option<(f64, T)> = None;
        let mut last = T::INFINITY;
        for _ in 0..MOST_TRIES {
            if steps > most {
                break;
            }
            let error = self.error(steps)?;
            if self.is_ended {
                return Ok(self.size(enough.unwrap_or(steps)));
            }
            let wanted = match error {
                Some(error) => {
                    last = error;
                    let met = error <= target;
                    if met {
                        enough = Some(steps);
                    } else {
                        few = few.max(steps);
                    }
                    if met && error * T::int(GOOD_ENOUGH) >= target {
                        return Ok(self.size(steps));
                    }
                    if !met && let Some((fewer, before)) = least {
                        // Twice the steps and no smaller error: rounding.
                        let no_gain = steps >= 2.0 * fewer && error > before / T::int(2);
                        if no_gain && before < small {
                            return Err(IntegrateError::TargetBelowRoundOff {
                                target,
                                reached: before.min(error),
                                step: self.size(fewer),
                            });
                        }
                    }
                    if least.is_none_or(|(_, before)| error < before / T::int(2)) {
                        least = Some((steps, error));
                    }
                    let law = power((error / target).to_f64(), 1.0 / order);
                    steps * (law / SAFETY).clamp(0.25, 4.0)
                }
                // Steps of this size fail.
                None => {
                    few = few.max(steps);
                    2.0 * steps
                }
            };
            let wanted = wanted.ceil().max(few + 1.0);
            steps = match enough {
                Some(enough) if enough <= few + 1.0 || enough <= 1.05 * few => {
                    return Ok(self.size(enough));
                }
                Some(1.0) => return Ok(self.size(1.0)),
                Some(enough) if wanted >= enough => ((few.max(1.0) * enough).sqrt().ceil())
                    .max(few + 1.0)
                    .min(enough - 1.0),
                _ => wanted,
            };
        }
        match enough {
            Some(enough) => Ok(self.size(enough)),
            None => Err(IntegrateError::TargetNotReached {
                target,
                error: last,
                step: self.size(few.max(1.0)),
            }),
        }
    }

    fn size(&self, steps: f64) -> T {
        self.length / T::exact(steps)
    }

    /// The error of a trial with this number of steps; `None` if steps of this size fail.
    fn error(&mut self, steps: f64) -> Result<Option<T>, IntegrateError<T>> {
        if let Target::Energy(_) = self.target {
            let gauss = Gauss::stages(self.method.stages);
            let method = match self.method.family {
                Family::Equip(_) => gauss,
                _ => self.method,
            };
            let run = self.run(method, steps, Record::Ends)?;
            let worst = run.and_then(|run| run.certificate().energy.as_ref().map(|e| e.max));
            return Ok(worst.filter(|worst| worst.is_finite()));
        }
        let coarse = self.run(self.method, steps, Record::All)?;
        let Some(coarse) = coarse else {
            return Ok(None);
        };
        let fine = self.run(self.method, 2.0 * steps, Record::Every(2))?;
        let Some(fine) = fine.filter(|fine| fine.len() == coarse.len()) else {
            return Ok(None);
        };
        let mut worst = T::int(0);
        for i in 0..coarse.len() {
            let pairs = coarse.q(i).iter().chain(coarse.p(i));
            let pairs = pairs.zip(fine.q(i).iter().chain(fine.p(i)));
            worst = pairs.fold(worst, |worst, (&a, &b)| worst.max((a - b).abs()));
        }
        Ok(worst.is_finite().then_some(worst))
    }

    /// The trial run; `None` if it fails.
    fn run(
        &mut self,
        method: Method,
        steps: f64,
        record: Record,
    ) -> Result<Option<Run<T>>, IntegrateError<T>> {
        if self.is_ended {
            return Ok(None);
        }
        let options = method.step(self.size(steps)).record(record);
        let (q, p) = self.start;
        let (observer, is_ended) = (&mut *self.observer, &mut self.is_ended);
        let mut watched = |view: &StepView<'_, T>| {
            let flow = observer.step(view);
            *is_ended |= flow.is_break();
            flow
        };
        match options.integrate_observed(self.system, q, p, self.interval.clone(), &mut watched) {
            Ok(run) => Ok(Some(run)),
            Err(RunFailure {
                partial: Some(_), ..
            }) => Ok(None),
            Err(failure) => Err(failure.error),
        }
    }
}

impl<T: Float> Integrator<T> {
    /// A fixed step that would meet the tolerance everywhere in `interval`: the smallest of the steps that
    /// step control chooses in a run by the tolerance.
    ///
    /// # Errors
    /// The errors of [`integrate`](Self::integrate), an empty interval, and fixed steps.
    pub fn suggest_step(
        &self,
        system: &Hamiltonian,
        q0: &[T],
        p0: &[T],
        interval: RangeInclusive<T>,
    ) -> Result<T, IntegrateError<T>> {
        if interval.start() == interval.end() {
            return Err(IntegrateError::Option {
                option: "length of the interval",
                value: T::int(0),
                expected: "more than zero, for a step to be suggested",
            });
        }
        if let StepSizes::Fixed(_) = self.sizes {
            let option = "suggest_step";
            return Err(IntegrateError::MisplacedOption { option });
        }
        let mut integrator = self.clone();
        integrator.options.record = Record::Ends;
        let run = integrator
            .integrate(system, q0, p0, interval)
            .map_err(|failure| failure.error)?;
        let steps = run.certificate().variable_steps;
        Ok(steps.map_or(T::int(0), |steps| steps.smallest))
    }
}
