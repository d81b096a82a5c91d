//! [`ReversibleStepper`]: a run with reversible steps, one at a time, and whole runs.

use crate::control::policy::{MOST_TRIES, ROUNDING};
use crate::control::step_density::StepDensity;
use crate::error::IntegrateError;
use crate::options::reversible::StepRule;
use crate::report::certificate::Certificate;
use crate::steppers::stepper::Stepper;
use crate::steppers::view::StepView;
use equip_scalar::Float;
use equip_solver::{Counts, Outcome};

/// A run with reversible steps that is made step by step.
#[derive(Debug)]
pub struct ReversibleStepper<T: Float> {
    pub(crate) inner: Stepper<T>,
    pub(super) sigma: StepDensity<T>,
    pub(super) rule: StepRule,
    pub(super) epsilon: T,
    /// z of the last step.
    pub(super) density: T,
    pub(super) time_low: T,
    pub(super) end: Option<T>,
    /// The stages Y_i, one after the other.
    pub(super) points: Vec<T>,
}

impl<T: Float> ReversibleStepper<T> {
    /// ε G at the present state, G in the direction in which the run goes.
    fn change(&mut self) -> Result<T, IntegrateError<T>> {
        let direction = self.inner.direction;
        let (energy, counts) = self.inner.core.energy_and_counts();
        let rate = (self.sigma).rate(&self.inner.y.hi, direction, energy, counts)?;
        Ok(self.epsilon * rate)
    }

    /// Makes the next step, but not beyond `end`, which the last step meets exactly.
    pub(super) fn advance_within(
        &mut self,
        end: Option<T>,
    ) -> Result<StepView<'_, T>, IntegrateError<T>> {
        let direction = self.inner.direction;
        let mut density = self.density + self.change()?;
        let (now, low) = (self.inner.time(), self.time_low);
        if !(density > T::int(0)) {
            return Err(IntegrateError::Option {
                option: "epsilon",
                value: self.epsilon,
                expected: "so small that σ does not grow by more than itself in a step",
            });
        }
        let left = end.map_or(T::INFINITY, |end| direction.signed((end - now) - low));
        let mut size = self.epsilon / density;
        let mut made = None;
        if self.rule == StepRule::Integral && left > size {
            let (met, outcome) = self.meet_rule(size)?;
            (size, density) = (met, self.epsilon / met);
            made = Some(outcome);
        }
        let end = end.filter(|_| left <= size);
        let size = if end.is_some() { left } else { size };
        let h = direction.signed(size);
        let (time, time_low) = match end {
            Some(end) => (end, T::int(0)),
            None => {
                let (sum, lost) = T::two_sum(now, h);
                T::two_sum(sum, lost + low)
            }
        };
        if !direction.is_before(now, time) {
            return Err(IntegrateError::StepBelowTimeResolution { step: h, time: now });
        }
        let outcome = match made {
            Some(outcome) if end.is_none() => outcome,
            Some(_) => {
                self.inner.core.refuse();
                self.inner.attempt(h)?
            }
            None => self.inner.attempt(h)?,
        };
        self.inner.check_domains(h)?;
        self.density = density;
        self.time_low = time_low;
        if let Some(steps) = &mut self.inner.variable {
            steps.largest = steps.largest.max(size);
            if end.is_none() {
                steps.smallest = steps.smallest.min(size);
            }
        }
        self.inner.accept(time, h, outcome);
        Ok(self.inner.view())
    }

    /// The size for which h Σ b_i/σ(Y_i) = ε, by a secant from `h`, and the outcome of the step of this size,
    /// which is made. To round-off: what is left of the rule's error a step backwards takes as a shift in
    /// time.
    fn meet_rule(&mut self, h: T) -> Result<(T, Outcome), IntegrateError<T>> {
        let mut secant = Secant {
            h,
            slope: T::int(1) / h,
            last: None,
        };
        // α_k change the stages as little as the end point: they need not be there until the size nearly is.
        let constraints = self.inner.core.replace_constraints(Vec::new());
        if !constraints.is_empty() {
            let near = self.search(&mut secant, T::EPSILON.cbrt());
            self.inner.core.replace_constraints(constraints);
            let (_, miss) = near?;
            self.inner.core.refuse();
            secant.step(miss);
        }
        let (outcome, _) = self.search(&mut secant, T::int(ROUNDING) * T::EPSILON)?;
        Ok((secant.h, outcome))
    }

    /// Makes steps until one misses the rule by at most `close` of ε or as little as rounding lets it; its
    /// outcome and miss. Where α_k are there with one size and not with the next, no size may be as close:
    /// the last one that is tried is taken then, if it is near.
    fn search(
        &mut self,
        secant: &mut Secant<T>,
        close: T,
    ) -> Result<(Outcome, T), IntegrateError<T>> {
        let (near, mut before) = (T::EPSILON.cbrt(), T::INFINITY);
        for tries in 1..=MOST_TRIES {
            let outcome = self.inner.attempt(self.inner.direction.signed(secant.h))?;
            let miss = secant.h * self.mean_density()? / self.epsilon - T::int(1);
            let stagnates = miss.abs() <= near * near && miss.abs() > before / T::int(4);
            let is_enough = tries == MOST_TRIES && miss.abs() <= near;
            if miss.abs() <= close || stagnates || is_enough {
                return Ok((outcome, miss));
            }
            before = miss.abs();
            self.inner.core.refuse();
            if let Some(steps) = &mut self.inner.variable {
                steps.rejected += 1;
            }
            secant.step(miss);
        }
        Err(IntegrateError::StepRuleNotMet {
            time: self.inner.time(),
            step: secant.h,
            miss: before,
        })
    }

    /// Σ b_i/σ(Y_i) over the stages of the step just tried.
    fn mean_density(&mut self) -> Result<T, IntegrateError<T>> {
        let Stepper { core, y, .. } = &mut self.inner;
        let n = y.hi.len();
        core.stages_by_stage(y, &mut self.points);
        let mut sum = T::int(0);
        for (i, point) in self.points.chunks_exact(n).enumerate() {
            let b = core.method().weights()[i];
            let (energy, counts) = core.energy_and_counts();
            sum += b * self.sigma.at(point, energy, counts)?;
        }
        Ok(sum)
    }

    /// Turns the run round in time: the steps from here on are the steps so far, backwards.
    ///
    /// # Errors
    /// When σ is not positive.
    pub fn turn_back(&mut self) -> Result<(), IntegrateError<T>> {
        let change = self.change()?;
        self.density += change;
        self.inner.turn_back();
        self.end = None;
        Ok(())
    }

    /// Puts the run at (`q`, `p`), each of length m, at the time it has reached; see [`Stepper::set_state`].
    /// The step density begins anew there.
    ///
    /// # Errors
    /// Faults of the values, an H that is not finite there, and a σ that is not positive.
    pub fn set_state(&mut self, q: &[T], p: &[T]) -> Result<(), IntegrateError<T>> {
        self.check_density((q, p), self.inner.time())?;
        self.inner.set_state(q, p)?;
        self.begin_density()
    }

    /// Whether a run can go on from this state.
    ///
    /// # Errors
    /// If it cannot; it stays where it is.
    pub(super) fn check_density(
        &mut self,
        (q, p): (&[T], &[T]),
        t: T,
    ) -> Result<(), IntegrateError<T>> {
        self.inner.look_at(q, p, t)?;
        let Stepper {
            core,
            next,
            direction,
            ..
        } = &mut self.inner;
        let (energy, uncounted) = (core.energy_mut(), &mut Counts::default());
        self.sigma.at(&next.hi, energy, uncounted)?;
        self.sigma.rate(&next.hi, *direction, energy, uncounted)?;
        Ok(())
    }

    /// z half a change behind the present state, so that the first whole one leads to z_{1/2}.
    pub(super) fn begin_density(&mut self) -> Result<(), IntegrateError<T>> {
        let (energy, counts) = self.inner.core.energy_and_counts();
        let density = (self.sigma).at(&self.inner.y.hi, energy, counts)?;
        self.density = density - self.change()? / T::int(2);
        Ok(())
    }

    /// The step made last, or the initial state.
    pub fn view(&self) -> StepView<'_, T> {
        self.inner.view()
    }

    /// Time reached.
    pub fn time(&self) -> T {
        self.inner.time()
    }

    /// The certificate of the run so far.
    pub fn certificate(&self) -> Certificate<T> {
        self.inner.certificate()
    }
}

/// A root of the rule on the way: size, slope of what it misses, and the size and the miss before.
#[derive(Debug)]
struct Secant<T> {
    h: T,
    slope: T,
    last: Option<(T, T)>,
}

impl<T: Float> Secant<T> {
    /// The next size, at most twice or half the last one.
    fn step(&mut self, miss: T) {
        let h = self.h;
        if let Some((size, before)) = self.last {
            // Sizes that hardly differ tell nothing new of the slope.
            let slope = (miss - before) / (h - size);
            if (h - size).abs() > T::EPSILON.cbrt() * h && slope > T::int(0) {
                self.slope = slope;
            }
        }
        self.last = Some((h, miss));
        let two = T::int(2);
        self.h = (h - miss / self.slope).max(h / two).min(h * two);
    }
}
