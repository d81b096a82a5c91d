//! [`Stepper`]: the run one step at a time.

use crate::certificate::{Certificate, VariableSteps};
use crate::constraint::Constraint;
use crate::error::IntegrateError;
use crate::invariant::{Defect, Watched};
use crate::method::Method;
use crate::newton::NewtonRecord;
use crate::options::FixedStep;
use crate::outcome::{Counts, Outcome};
use crate::state::State;
use crate::step::Core;
use crate::tangent_chaos::ChaosIndicators;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_tableau::Gauss;
use std::time::Instant;

/// An accepted step, as observers see it. Borrowed: nothing is copied.
#[derive(Debug, Clone, Copy)]
pub struct StepView<'a, T> {
    /// Number of the step, from 1; 0 is the initial state.
    pub index: u64,
    /// Time at its end: t0 + index · h.
    pub time: T,
    /// Its size.
    pub step: T,
    /// Positions at its end.
    pub q: &'a [T],
    /// Momenta at its end.
    pub p: &'a [T],
    /// H − H_ref at its end; `None` if it was not measured.
    pub energy_defect: Option<T>,
    /// Round-off floor of the energy defect, for steps that have an energy to reach.
    pub energy_floor: Option<T>,
    /// α_1 … α_{s−1} of the step (of its last part, if it was halved).
    pub alphas: &'a [T],
    /// How it ended.
    pub outcome: Outcome,
    /// Lyapunov exponent and MEGNO so far, if the run follows a deviation.
    pub chaos: Option<ChaosIndicators<T>>,
}

/// An accepted step that owns its state, as the iterator gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct Step<T> {
    /// Number of the step, from 1.
    pub index: u64,
    /// Time at its end.
    pub time: T,
    /// Positions at its end.
    pub q: Vec<T>,
    /// Momenta at its end.
    pub p: Vec<T>,
    /// H − H_ref at its end; `None` if it was not measured.
    pub energy_defect: Option<T>,
    /// α_1 … α_{s−1} of the step.
    pub alphas: Vec<T>,
    /// How it ended.
    pub outcome: Outcome,
}

impl<T: Float> StepView<'_, T> {
    /// A copy that owns its state.
    pub fn to_step(&self) -> Step<T> {
        Step {
            index: self.index,
            time: self.time,
            q: self.q.to_vec(),
            p: self.p.to_vec(),
            energy_defect: self.energy_defect,
            alphas: self.alphas.to_vec(),
            outcome: self.outcome,
        }
    }
}

/// A run that is made step by step: an endless iterator, or [`advance`](Self::advance) without copies.
#[derive(Debug)]
pub struct Stepper<T: Float, E> {
    pub(crate) core: Core<T, E>,
    method: Method,
    has_target: bool,
    pub(crate) t0: T,
    h: T,
    pub(crate) h_ref: T,
    pub(crate) index: u64,
    pub(crate) time: T,
    pub(crate) y: State<T>,
    next: State<T>,
    measure_energy: bool,
    pub(crate) energy: Option<Defect<T>>,
    pub(crate) in_floors: Option<T>,
    pub(crate) watched: Vec<Watched<T>>,
    pub(crate) alpha_range: Vec<(T, T)>,
    pub(crate) last: (T, Outcome),
    pub(crate) floor: Option<T>,
    /// What a run with variable steps has to say about them.
    pub(crate) variable: Option<VariableSteps<T>>,
    pub(crate) begun: Instant,
    /// Method and options, for checkpoints.
    pub(crate) fingerprint: String,
}

impl<T: Float> FixedStep<T> {
    /// Starts a run at (`q0`, `p0`), each of length m, at time `t0`, without making a step.
    ///
    /// # Errors
    /// Every fault of options, step and initial values, and an H that is not finite at the start.
    pub fn start<H: System>(
        &self,
        system: &H,
        q0: &[T],
        p0: &[T],
        t0: T,
    ) -> Result<Stepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        let settings = self.validate()?;
        check_initial(system.degrees_of_freedom(), q0, p0)?;
        if t0 + self.h == t0 || !t0.is_finite() {
            return Err(IntegrateError::StepBelowTimeResolution {
                step: self.h,
                time: t0,
            });
        }
        let stages = settings.stages;
        let gauss = Gauss::new(stages).map_err(|_| IntegrateError::StagesOutOfRange {
            stages,
            min: 1,
            max: crate::MAX_STAGES,
        })?;
        let y = State::new(q0, p0);
        let mut evaluator = system.evaluator::<T>();
        let mut gradient = vec![T::int(0); y.hi.len()];
        let h_ref = evaluator.gradient_with_compensated_value(&y.hi, &mut gradient);
        if !h_ref.is_finite() || gradient.iter().any(|g| !g.is_finite()) {
            return Err(IntegrateError::EnergyNotFinite { energy: h_ref });
        }
        for invariant in self.invariants.iter().chain(&self.kept) {
            let (expected, found) = (
                system.degrees_of_freedom(),
                invariant.function().degrees_of_freedom(),
            );
            if expected != found {
                return Err(IntegrateError::WrongLength {
                    what: "an invariant",
                    expected,
                    found,
                });
            }
        }
        let has_target = settings.first_alpha.is_some() && !system.structure().is_quadratic();
        let mut constraints = Vec::new();
        if has_target {
            constraints.push(Constraint::energy(h_ref, y.hi.len()));
        }
        constraints.extend(self.kept.iter().map(|i| Constraint::invariant(i, &y.hi)));
        let free = settings.first_alpha.map_or(0, |first| stages - first);
        if constraints.len() > free {
            let (kept, alphas) = (constraints.len(), free);
            return Err(IntegrateError::TooFewAlphas { kept, alphas });
        }
        let alphas = if constraints.is_empty() {
            0
        } else {
            stages - 1
        };
        let mut core = Core::new(system, evaluator, settings, gauss, constraints);
        core.find_springs(system.structure(), (&y.hi, self.h));
        let measured = has_target || self.measure_energy;
        Ok(Stepper {
            method: self.method,
            has_target,
            t0,
            h: self.h,
            h_ref,
            index: 0,
            time: t0,
            next: y.clone(),
            measure_energy: self.measure_energy,
            energy: measured.then(|| Defect::new("energy", h_ref)),
            in_floors: has_target.then(|| T::int(0)),
            watched: self
                .kept
                .iter()
                .chain(&self.invariants)
                .map(|i| Watched::new(i, &y.hi))
                .collect(),
            alpha_range: vec![(T::int(0), T::int(0)); alphas],
            last: (T::int(0), Outcome::NotAsked),
            floor: None,
            variable: None,
            begun: Instant::now(),
            fingerprint: self.fingerprint(),
            y,
            core,
        })
    }
}

fn check_initial<T: Float>(m: usize, q0: &[T], p0: &[T]) -> Result<(), IntegrateError<T>> {
    for (what, values) in [("q0", q0), ("p0", p0)] {
        if values.len() != m {
            let found = values.len();
            return Err(IntegrateError::WrongLength {
                what,
                expected: m,
                found,
            });
        }
        if let Some((index, &value)) = values.iter().enumerate().find(|(_, x)| !x.is_finite()) {
            return Err(IntegrateError::InitialNotFinite { what, index, value });
        }
    }
    Ok(())
}

impl<T: Float, E: Evaluate<T>> Stepper<T, E> {
    /// Makes the next step.
    ///
    /// # Errors
    /// When the step cannot be made; the state then is that before the step, and may be read or stepped again.
    pub fn advance(&mut self) -> Result<StepView<'_, T>, IntegrateError<T>> {
        let time = self.t0 + T::int((self.index + 1) as i64) * self.h;
        self.advance_to(time, self.h)
    }

    /// Makes a step of size `h` that is taken to end at `time`.
    pub(crate) fn advance_to(
        &mut self,
        time: T,
        h: T,
    ) -> Result<StepView<'_, T>, IntegrateError<T>> {
        if !(time > self.time) {
            return Err(IntegrateError::StepBelowTimeResolution {
                step: h,
                time: self.time,
            });
        }
        let outcome = self.attempt(h)?;
        self.accept(time, h, outcome);
        Ok(self.view())
    }

    /// Makes a step of size `h` that may still be refused.
    pub(crate) fn attempt(&mut self, h: T) -> Result<Outcome, IntegrateError<T>> {
        self.core.step(&self.y, self.time, h, &mut self.next)
    }

    /// Takes the step made by [`attempt`](Self::attempt), which ends at `time`.
    pub(crate) fn accept(&mut self, time: T, h: T, outcome: Outcome) {
        std::mem::swap(&mut self.y, &mut self.next);
        self.index += 1;
        self.time = time;
        self.last = (h, outcome);
        self.core.counts.record(outcome);
        self.measure(outcome);
    }

    /// Energy, invariants and α's of the step just made.
    fn measure(&mut self, outcome: Outcome) {
        self.floor = None;
        // Zero is in all of them from the beginning.
        if !self.core.stages.alphas_are_zero {
            for (range, &alpha) in self.alpha_range.iter_mut().zip(&self.core.stages.alphas) {
                *range = (range.0.min(alpha), range.1.max(alpha));
            }
        }
        if self.has_target {
            let residual = &self.core.constraints[0];
            self.floor = Some(residual.judging_floor());
            if let Some(energy) = &mut self.energy {
                energy.see(residual.defect);
            }
            if let Some(most) = &mut self.in_floors
                && outcome.energy_kept()
            {
                *most = most.max(residual.in_judging_floors());
            }
        } else if self.measure_energy {
            self.core.counts.energies += 1;
            let value = self.core.energy.compensated_value(&self.y.hi);
            if let Some(energy) = &mut self.energy {
                energy.see(value - self.h_ref);
            }
        }
        for watched in &mut self.watched {
            watched.see(&self.y.hi);
        }
    }

    /// The step made last, or the initial state.
    pub fn view(&self) -> StepView<'_, T> {
        let (q, p) = self.y.hi.split_at(self.y.hi.len() / 2);
        StepView {
            index: self.index,
            time: self.time,
            step: self.last.0,
            q,
            p,
            energy_defect: self.energy.as_ref().map(|e| e.end),
            energy_floor: self.floor,
            alphas: &self.core.stages.alphas,
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
        &self.core.counts
    }

    /// The Newton iterations of the step (or part of a halved step) solved last.
    pub fn newton_history(&self) -> &[NewtonRecord<T>] {
        &self.core.newton.history
    }

    fn mean_step(&self) -> T {
        let steps = i64::try_from(self.index).unwrap_or(i64::MAX);
        (self.time - self.t0) / T::int(steps.max(1))
    }

    /// The certificate of the run so far.
    pub fn certificate(&self) -> Certificate<T> {
        Certificate {
            method: self.method,
            step: match self.variable {
                None => self.h,
                Some(_) => self.mean_step(),
            },
            variable_steps: self.variable,
            start: self.t0,
            end: self.time,
            energy: self.energy.clone(),
            energy_in_floors: self.in_floors,
            invariants: self.watched.iter().map(|w| w.defect.clone()).collect(),
            alpha_range: self.alpha_range.clone(),
            chaos: None,
            counts: self.core.counts,
            unresolved_spring: self.core.unresolved_spring,
            output_steps: 0,
            seconds: self.begun.elapsed().as_secs_f64(),
        }
    }
}

impl<T: Float, E: Evaluate<T>> Iterator for Stepper<T, E> {
    type Item = Result<Step<T>, IntegrateError<T>>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(self.advance().map(|view| view.to_step()))
    }
}
