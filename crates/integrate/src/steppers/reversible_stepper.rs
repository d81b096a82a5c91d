//! [`ReversibleStepper`]: a run with reversible steps, one at a time, and whole runs.

use crate::checkpoints::checkpoint::Checkpoint;
use crate::checkpoints::exact::Exact;
use crate::checkpoints::memories::ControlMemory;
use crate::control::step_density::StepDensity;
use crate::error::IntegrateError;
use crate::options::reversible::{Reversible, StepRule};
use crate::report::certificate::Certificate;
use crate::report::variable_steps::VariableSteps;
use crate::steppers::stepper::Stepper;
use crate::steppers::view::StepView;
use crate::tangent::steps::sealed::Followed;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_solver::{Core, Outcome};

/// Tries to meet the integral rule.
const MOST_TRIES: u32 = 25;
/// A size that meets it within so many units of the last place meets it.
const ROUND_OFF: i64 = 16;

/// A run with reversible steps that is made step by step.
#[derive(Debug)]
pub struct ReversibleStepper<T: Float, E> {
    pub(crate) inner: Stepper<T, E>,
    sigma: StepDensity<T>,
    rule: StepRule,
    epsilon: T,
    /// z of the last step.
    density: T,
    pub(crate) time_low: T,
    pub(crate) end: T,
    /// The stages Y_i, one after the other.
    points: Vec<T>,
}

impl<T: Float> Reversible<T> {
    /// Starts a run at (`q0`, `p0`), each of length m, at time `t0`, without making a step.
    ///
    /// # Errors
    /// Every fault of options and initial values, a σ of another length or that is not positive at the start, and an H that is not finite there.
    pub fn start<H: System>(
        &self,
        system: &H,
        q0: &[T],
        p0: &[T],
        t0: T,
    ) -> Result<ReversibleStepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        self.validate()?;
        let inner = self.base.start(system, q0, p0, t0)?;
        let mut stepper = self.around(system, inner)?;
        let (energy, counts) = stepper.inner.core.energy_and_counts();
        let density = (stepper.sigma).at(&stepper.inner.y.hi, energy, counts)?;
        let half = stepper.change()? / T::int(2);
        // Half a change behind the start, so that the first whole one leads to z_{1/2}.
        stepper.density = density - half;
        Ok(stepper)
    }

    /// The run that `checkpoint` was made of, bit for bit as if it had not stopped.
    ///
    /// # Errors
    /// See [`FixedStep::resume`](crate::FixedStep::resume).
    pub fn resume<H: System>(
        &self,
        system: &H,
        checkpoint: &Checkpoint,
    ) -> Result<ReversibleStepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        let inner = (self.base).resume_as(system, checkpoint, self.fingerprint())?;
        let mut stepper = self.around(system, inner)?;
        let Some(memory) = &checkpoint.control else {
            return Err(IntegrateError::CheckpointDamaged {
                what: "the memory of step control",
            });
        };
        stepper.density = memory.next.read()?;
        stepper.time_low = checkpoint.time_low.read()?;
        if let Some(steps) = &mut stepper.inner.variable {
            steps.smallest = memory.smallest.read()?;
            steps.largest = memory.largest.read()?;
        }
        Ok(stepper)
    }

    fn around<H: System>(
        &self,
        system: &H,
        mut inner: Stepper<T, H::Evaluator<T>>,
    ) -> Result<ReversibleStepper<T, H::Evaluator<T>>, IntegrateError<T>> {
        let (n, stages) = (inner.y.hi.len(), inner.core.gauss().stages());
        inner.fingerprint = self.fingerprint();
        inner.variable = Some(VariableSteps {
            tolerance: self.epsilon,
            smallest: T::INFINITY,
            largest: T::int(0),
            rejected: 0,
            failed: 0,
        });
        Ok(ReversibleStepper {
            sigma: StepDensity::new(system, self.sigma.as_ref())?,
            rule: self.rule,
            epsilon: self.epsilon,
            density: T::int(0),
            time_low: T::int(0),
            end: T::INFINITY,
            points: vec![T::int(0); stages * n],
            inner,
        })
    }
}

impl<T: Float, E: Evaluate<T>> ReversibleStepper<T, E> {
    /// ε G at the present state.
    fn change(&mut self) -> Result<T, IntegrateError<T>> {
        let (energy, counts) = self.inner.core.energy_and_counts();
        let rate = self.sigma.rate(&self.inner.y.hi, energy, counts)?;
        Ok(self.epsilon * rate)
    }

    /// Makes the next step.
    ///
    /// # Errors
    /// When the step cannot be made, or σ or the density is no longer positive; the state then is that before the step.
    pub fn advance(&mut self) -> Result<StepView<'_, T>, IntegrateError<T>> {
        let mut density = self.density + self.change()?;
        let (now, low) = (self.inner.time(), self.time_low);
        let left = (self.end - now) - low;
        let mut h = self.epsilon / density;
        let mut made = None;
        if self.rule == StepRule::Integral && left > h {
            let (met, outcome) = self.meet_rule(h)?;
            (h, density) = (met, self.epsilon / met);
            made = Some(outcome);
        }
        let cut = left <= h;
        let h = if cut { left } else { h };
        let (sum, lost) = T::two_sum(now, h);
        let (time, time_low) = T::two_sum(sum, lost + low);
        let (time, time_low) = if cut {
            (self.end, T::int(0))
        } else {
            (time, time_low)
        };
        if !(density > T::int(0)) || !(time > now) {
            return Err(IntegrateError::StepBelowTimeResolution { step: h, time: now });
        }
        let outcome = match made {
            Some(outcome) if !cut => outcome,
            Some(_) => {
                self.inner.core.refuse();
                self.inner.attempt(h)?
            }
            None => self.inner.attempt(h)?,
        };
        self.density = density;
        self.time_low = time_low;
        if let Some(steps) = &mut self.inner.variable {
            steps.largest = steps.largest.max(h);
            if !cut {
                steps.smallest = steps.smallest.min(h);
            }
        }
        self.inner.accept(time, h, outcome);
        Ok(self.inner.view())
    }

    /// The size for which h Σ b_i/σ(Y_i) = ε, by a secant from `h`, and the outcome of the step of this size, which is made. To round-off: what is left of the
    /// rule's error a step backwards takes as a shift in time.
    fn meet_rule(&mut self, h: T) -> Result<(T, Outcome), IntegrateError<T>> {
        let mut secant = Secant {
            h,
            slope: T::int(1) / h,
            last: None,
        };
        // α's change the stages as little as the end point: they need not be there until the size nearly is.
        let constraints = self.inner.core.replace_constraints(Vec::new());
        if !constraints.is_empty() {
            let near = self.search(&mut secant, T::EPSILON.cbrt());
            self.inner.core.replace_constraints(constraints);
            let (_, miss) = near?;
            self.inner.core.refuse();
            secant.step(miss);
        }
        let (outcome, _) = self.search(&mut secant, T::int(ROUND_OFF) * T::EPSILON)?;
        Ok((secant.h, outcome))
    }

    /// Makes steps until one misses the rule by at most `close` of ε or as little as rounding lets it; its outcome and miss.
    fn search(
        &mut self,
        secant: &mut Secant<T>,
        close: T,
    ) -> Result<(Outcome, T), IntegrateError<T>> {
        let (near, mut before) = (T::EPSILON.cbrt(), T::INFINITY);
        for _ in 0..MOST_TRIES {
            let outcome = self.inner.attempt(secant.h)?;
            let miss = secant.h * self.mean_density()? / self.epsilon - T::int(1);
            let stagnates = miss.abs() <= near * near && miss.abs() > before / T::int(4);
            if miss.abs() <= close || stagnates {
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
            let b = core.gauss().weights()[i];
            let (energy, counts) = core.energy_and_counts();
            sum += b * self.sigma.at(point, energy, counts)?;
        }
        Ok(sum)
    }

    /// Turns the momenta round: the steps from here on are the steps so far, backwards, while time goes on. For an H that is even in p.
    ///
    /// # Errors
    /// When σ is not positive.
    pub fn turn_back(&mut self) -> Result<(), IntegrateError<T>> {
        let change = self.change()?;
        self.density += change;
        let m = self.inner.y.hi.len() / 2;
        for j in m..2 * m {
            self.inner.y.hi[j] = -self.inner.y.hi[j];
            self.inner.y.lo[j] = -self.inner.y.lo[j];
        }
        self.inner.core.forget();
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

    /// The run as it is now, to be resumed by the same options.
    pub fn checkpoint(&mut self) -> Checkpoint {
        let mut checkpoint = self.inner.checkpoint();
        checkpoint.time_low = Exact::of(self.time_low);
        checkpoint.control = self.inner.variable.map(|steps| ControlMemory {
            next: Exact::of(self.density),
            held: Exact::of(T::int(1)),
            tries: 0,
            smallest: Exact::of(steps.smallest),
            largest: Exact::of(steps.largest),
            rejected: 0,
            failed: 0,
        });
        checkpoint
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

impl<T: Float, E> Followed<T, E> for ReversibleStepper<T, E> {
    fn core(&self) -> &Core<T, E> {
        &self.inner.core
    }

    fn core_mut(&mut self) -> &mut Core<T, E> {
        &mut self.inner.core
    }

    fn time_reached(&self) -> T {
        self.inner.time
    }
}
