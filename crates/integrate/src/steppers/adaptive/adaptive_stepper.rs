//! [`AdaptiveStepper`]: a run with variable steps, one step at a time.
//!
//! Every step: solve at the proposed size → estimate → accept, or refuse and try a better size from the same
//! state. The stages of a refused step are the guess of the next try. Time is summed with compensation.
//!
//! A step over a switch of H, a kink or a jump, is one that is refused for a shorter one that ends there
//! ([`super::over_switches`]).

use crate::control::controller::{Control, Judgement};
use crate::control::estimate::Decay;
use crate::control::first_step::FirstSize;
use crate::control::flow::Flow;
use crate::control::policy::{MOST_TRIES, PART};
use crate::control::stuck::TooSmall;
use crate::error::IntegrateError;
use crate::events::crossings::Crossings;
use crate::report::certificate::Certificate;
use crate::report::variable_steps::VariableSteps;
use crate::steppers::adaptive::made::{EndIs, Made, Place};
use crate::steppers::stepper::Stepper;
use crate::steppers::view::{Step, StepView};
use equip_scalar::Float;
use equip_solver::{Counts, Outcome};

/// A run with variable steps that is made step by step: an endless iterator, or [`advance`](Self::advance)
/// without copies.
#[derive(Debug)]
pub struct AdaptiveStepper<T: Float> {
    pub(crate) inner: Stepper<T>,
    pub(super) control: Control,
    pub(super) decay: Decay<T>,
    pub(super) flow: Flow<T>,
    /// ∇H where the step begins, and where it ends.
    pub(super) slopes: [Vec<T>; 2],
    /// What rounding makes of ∇H at the end of a step, where that was asked for.
    pub(super) slope_rounding: Vec<T>,
    /// None if H is smooth as far as is known.
    pub(super) crossings: Option<Crossings<T>>,
    pub(super) first: FirstSize<T>,
    pub(super) first_step: Option<T>,
    /// The first step is not made longer than this.
    pub(super) longest_first: f64,
    pub(super) tolerance: T,
    /// What rounding lost of the time.
    pub(super) time_low: T,
    /// Where the run ends, if that is known.
    pub(super) end: Option<T>,
    pub(super) min_step: T,
    pub(super) max_steps: u64,
    /// Tries of the first step so far; none once its size is settled.
    pub(super) tries: Option<u32>,
}

impl<T: Float> AdaptiveStepper<T> {
    /// Turns the run round in time: the steps from here on go the other way.
    pub fn turn_back(&mut self) {
        self.inner.turn_back();
        self.end = None;
        if let Some(crossings) = &mut self.crossings {
            crossings.turn_back();
        }
    }

    /// Makes the next step, but not beyond `end`, which the last step meets exactly.
    pub(crate) fn advance_within(
        &mut self,
        end: Option<T>,
    ) -> Result<StepView<'_, T>, IntegrateError<T>> {
        if self.inner.counts().steps >= self.max_steps {
            let (steps, time) = (self.max_steps, self.time());
            return Err(IntegrateError::StepLimit { steps, time });
        }
        let mut size = self.control.next;
        // The size that nothing but switches speaks against, and the one that knots allow.
        let (mut proposed, mut longest) = (size, f64::INFINITY);
        let (mut cause, mut is_retried) = (None, false);
        if let Some(crossings) = &mut self.crossings {
            crossings.begin_step();
        }
        let mut to_switch = None;
        loop {
            let place = to_switch.take().unwrap_or_else(|| self.place(size, end));
            let too_small = !self.inner.direction.is_before(self.time(), place.time)
                || (place.size < self.min_step && !place.cut);
            if too_small {
                return Err(self.too_small(place.size, cause));
            }
            let h = place.size.to_f64();
            match self.make_up_to_switches(place, end) {
                Ok(Made::OverSwitch(shorter)) => {
                    self.tries = None;
                    self.inner.core.refuse();
                    (to_switch, is_retried) = (Some(shorter), true);
                }
                Ok(Made::OverKnots) => {
                    self.tries = None;
                    self.inner.core.refuse();
                    (size, is_retried) = (self.control.shorter(h), true);
                    longest = size;
                    self.stop_aiming();
                }
                Ok(Made::Step(outcome, estimate, end_is)) => {
                    let contraction = self.inner.core.contraction();
                    let limits = (contraction, self.longest_first);
                    if let Some(tries) = self.tries.filter(|&tries| tries < MOST_TRIES)
                        && !place.cut
                        && end_is == EndIs::Smooth
                        && let Some(longer) = self.control.first_is_timid(h, &estimate, limits)
                    {
                        self.tries = Some(tries + 1);
                        self.inner.core.refuse();
                        (size, is_retried) = (longer, true);
                        continue;
                    }
                    match (self.control).judge(h, &estimate, (contraction, is_retried)) {
                        Judgement::Accept => {
                            let signed = self.inner.direction.signed(place.size);
                            self.inner.check_domains(signed)?;
                            self.accept(place, outcome);
                            self.accept_switches(end_is, (h, proposed));
                            let next = &mut self.control.next;
                            *next = next.min(longest);
                            return Ok(self.inner.view());
                        }
                        Judgement::Refuse(shorter) => {
                            self.tries = None;
                            self.inner.core.refuse();
                            self.count(|steps| &mut steps.rejected);
                            cause = None;
                            (size, is_retried) = (shorter, true);
                            proposed = shorter;
                            self.stop_aiming();
                        }
                    }
                }
                Err(error) => {
                    if error.stays_in_shorter_steps() {
                        return Err(error);
                    }
                    self.tries = None;
                    self.count(|steps| &mut steps.failed);
                    size = self.control.shorter(h);
                    proposed = size;
                    cause = Some(error);
                    self.stop_aiming();
                }
            }
        }
    }

    /// Why no step of this `size` can be made.
    fn too_small(&mut self, size: T, cause: Option<IntegrateError<T>>) -> IntegrateError<T> {
        let too_small = TooSmall {
            time: self.time(),
            h: self.inner.direction.signed(size),
            min: self.min_step,
            tolerance: self.tolerance,
        };
        let start = self.inner.start_state();
        let Stepper { core, y, .. } = &mut self.inner;
        too_small.error(core.energy_mut(), (&start, &y.hi), cause)
    }

    /// ∇H where the next step begins.
    pub(super) fn take_slope(&mut self) {
        let Stepper { core, y, .. } = &mut self.inner;
        core.energy_mut().gradient(&y.hi, &mut self.slopes[0]);
    }

    fn count(&mut self, which: impl Fn(&mut VariableSteps<T>) -> &mut u64) {
        if let Some(steps) = &mut self.inner.variable {
            *which(steps) += 1;
        }
    }

    /// Where a step of the given size leads; near `end`, one that meets it, or half of what is left: never a
    /// sliver.
    pub(super) fn place(&self, size: f64, end: Option<T>) -> Place<T> {
        let h = T::exact(size);
        let (now, low) = (self.time(), self.time_low);
        if let Some(end) = end {
            let left = self.inner.direction.signed((end - now) - low);
            let zero = T::int(0);
            // A step may be stretched a little to meet the end.
            let allowed = left <= h || left.to_f64() <= self.control.most;
            if left <= h + h / T::int(PART) && allowed {
                return Place {
                    size: left,
                    time: end,
                    time_low: zero,
                    cut: true,
                };
            }
            if left < h + h {
                return self.step_to(left / T::int(2), true);
            }
        }
        self.step_to(h, false)
    }

    pub(super) fn step_to(&self, size: T, cut: bool) -> Place<T> {
        let (sum, lost) = T::two_sum(self.time(), self.inner.direction.signed(size));
        let (time, time_low) = T::two_sum(sum, lost + self.time_low);
        Place {
            size,
            time,
            time_low,
            cut,
        }
    }

    fn accept(&mut self, place: Place<T>, outcome: Outcome) {
        self.tries = None;
        self.time_low = place.time_low;
        if let Some(steps) = &mut self.inner.variable {
            steps.largest = steps.largest.max(place.size);
            if !place.cut || steps.smallest > steps.largest {
                steps.smallest = steps.smallest.min(place.size);
            }
        }
        let h = self.inner.direction.signed(place.size);
        self.inner.accept(place.time, h, outcome);
        self.slopes.swap(0, 1);
    }

    /// Puts the run at (`q`, `p`), each of length m, at the time it has reached; see [`Stepper::set_state`].
    /// The size proposed for the next step stays, and is tried at shorter ones where it does not fit.
    ///
    /// # Errors
    /// Faults of the values, and an H that is not finite there.
    pub fn set_state(&mut self, q: &[T], p: &[T]) -> Result<(), IntegrateError<T>> {
        self.inner.set_state(q, p)?;
        self.take_slope();
        self.crossings.iter_mut().for_each(Crossings::begin);
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

    /// Size proposed for the next step.
    pub fn next_step(&self) -> T {
        T::exact(self.control.next)
    }

    /// Counts so far.
    pub fn counts(&self) -> &Counts {
        self.inner.counts()
    }

    /// The certificate of the run so far.
    pub fn certificate(&self) -> Certificate<T> {
        self.inner.certificate()
    }
}

impl<T: Float> Iterator for AdaptiveStepper<T> {
    type Item = Result<Step<T>, IntegrateError<T>>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(self.advance().map(|view| view.to_step()))
    }
}
