//! [`AdaptiveStepper`]: a run with variable steps, one step at a time.
//!
//! Every step: solve at the proposed size → estimate → accept, or refuse and try a better size from the same
//! state. The stages of a refused step are the guess of the next try. Time is summed with compensation.
//!
//! A step over a switch of H, a kink or a jump, is made anew to end there ([`crate::events::crossings`]),
//! unless what the kink makes of it is below the tolerance ([`crate::events::roughness`]).

use crate::control::controller::{Control, Judgement};
use crate::control::estimate::{Decay, End, Estimate};
use crate::control::first_step::FirstSize;
use crate::error::IntegrateError;
use crate::events::crossings::{Crossings, Meeting};
use crate::events::roughness::Roughness;
use crate::report::certificate::Certificate;
use crate::report::variable_steps::VariableSteps;
use crate::steppers::stepper::Stepper;
use crate::steppers::view::{Step, StepView};
use equip_autodiff::Evaluate;
use equip_scalar::Float;
use equip_solver::{Counts, Outcome};

/// Tries of the first step.
pub(super) const TRIES_FOR_FIRST: u32 = 20;
/// The first step is at least so many units of the last place of the time.
const RESOLVED: i64 = 16;
/// A step may be stretched by 1/16 to reach the end of the run, if that is no more than the largest allowed.
const STRETCH: i64 = 16;
/// A step that meets the first knot of a table within 1/8 of its size is halved before it ends there: knots
/// that many are passed over by steps that are not so much shorter.
const SOON: i64 = 8;

/// A run with variable steps that is made step by step: an endless iterator, or [`advance`](Self::advance)
/// without copies.
#[derive(Debug)]
pub struct AdaptiveStepper<T: Float, E> {
    pub(crate) inner: Stepper<T, E>,
    pub(super) control: Control,
    pub(super) decay: Decay<T>,
    /// ∇H where the step begins, and where it ends.
    pub(super) slopes: [Vec<T>; 2],
    /// None if H is smooth as far as is known.
    pub(super) crossings: Option<Crossings<T>>,
    pub(super) roughness: Option<Roughness<T>>,
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
    /// Tries of the first step made so far; all of them once it is made.
    pub(super) tries: u32,
}

/// A size, without a sign, and where it leads.
#[derive(Debug, Clone, Copy)]
struct Place<T> {
    size: T,
    time: T,
    time_low: T,
    cut: bool,
}

/// What has become of a step.
enum Made<T> {
    Step(Outcome, Estimate, EndIs),
    /// Only its stages were found: it is over a switch, and to be made up to it, …
    OverSwitch(Place<T>),
    /// … or half as long, where it is not known where it meets one.
    Rough,
}

/// Where a step ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum EndIs {
    /// There was no switch on its way.
    Smooth,
    OnSwitch,
    /// Beyond one that the tolerance allows it to pass over.
    BeyondSwitch,
}

impl<T: Float, E: Evaluate<T>> AdaptiveStepper<T, E> {
    /// Makes the next step, of the size that control proposes, the way the run goes: forward in time, unless
    /// it was [turned back](Self::turn_back).
    ///
    /// # Errors
    /// When no step above the smallest size can be made; the state then is that before the step.
    pub fn advance(&mut self) -> Result<StepView<'_, T>, IntegrateError<T>> {
        self.advance_within(None)
    }

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
        let mut size = self.control.memory.next;
        // The size that nothing but switches speaks against.
        let mut proposed = size;
        let mut longest = f64::INFINITY;
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
                return Err(cause.unwrap_or(IntegrateError::StepBelowMinimum {
                    time: self.time(),
                    step: place.size,
                    min: self.min_step,
                }));
            }
            let h = place.size.to_f64();
            match self.make(place, end) {
                Ok(Made::OverSwitch(shorter)) => {
                    self.tries = TRIES_FOR_FIRST;
                    self.inner.core.refuse();
                    (to_switch, is_retried) = (Some(shorter), true);
                }
                Ok(Made::Rough) => {
                    self.tries = TRIES_FOR_FIRST;
                    self.inner.core.refuse();
                    (size, is_retried) = (self.control.shorter(h), true);
                    longest = size;
                    self.stop_aiming();
                }
                Ok(Made::Step(outcome, estimate, end_is)) => {
                    if self.tries < TRIES_FOR_FIRST
                        && !place.cut
                        && end_is == EndIs::Smooth
                        && let Some(longer) =
                            self.control
                                .first_is_timid(h, &estimate, self.longest_first)
                    {
                        self.tries += 1;
                        self.inner.core.refuse();
                        (size, is_retried) = (longer, true);
                        continue;
                    }
                    // Sweeps from the stages of a refused try do not contract as others do.
                    let contraction = self.inner.core.contraction().filter(|_| !is_retried);
                    match self.control.judge(h, &estimate, contraction) {
                        Judgement::Accept => {
                            self.accept(place, outcome);
                            self.accept_crossing(end_is, (h, proposed));
                            let next = &mut self.control.memory.next;
                            *next = next.min(longest);
                            return Ok(self.inner.view());
                        }
                        Judgement::Refuse(shorter) => {
                            self.tries = TRIES_FOR_FIRST;
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
                    // A defect that is refused is as large in a shorter step.
                    if matches!(error, IntegrateError::NoAdmissibleAlpha { .. }) {
                        return Err(error);
                    }
                    self.tries = TRIES_FOR_FIRST;
                    self.count(|steps| &mut steps.failed);
                    size = self.control.shorter(h);
                    proposed = size;
                    cause = Some(error);
                    self.stop_aiming();
                }
            }
        }
    }

    /// Makes a step with its estimate, or only its stages if it is to end on a switch before.
    fn make(&mut self, place: Place<T>, end: Option<T>) -> Result<Made<T>, IntegrateError<T>> {
        let h = self.inner.direction.signed(place.size);
        let outcome = self.inner.attempt(h)?;
        let Stepper { core, y, next, .. } = &mut self.inner;
        let Some(crossings) = &mut self.crossings else {
            return Ok(Made::Step(outcome, self.estimate(h, false), EndIs::Smooth));
        };
        let was_aimed = crossings.is_aimed();
        // A switch beyond the end of the run is none.
        let is_last = end == Some(place.time);
        let is_on_the_way = |meeting: &Meeting<T>| match meeting {
            Meeting::At(root) => *root <= T::int(1) || !is_last,
            Meeting::End => true,
        };
        let meeting = crossings.look(core, y, next).filter(is_on_the_way);
        let is_among_knots = crossings.is_among_knots();
        let end_is = match meeting {
            Some(Meeting::End) => EndIs::OnSwitch,
            Some(Meeting::At(root)) => {
                let is_rough = was_aimed || self.is_rough(h, root);
                let is_soon = T::int(SOON) * root < T::int(1);
                if is_rough && is_soon && !was_aimed && self.halves_among_knots() {
                    return Ok(Made::Rough);
                }
                if is_rough && let Some(shorter) = self.place_of_switch(place.size * root, end) {
                    return Ok(Made::OverSwitch(shorter));
                }
                EndIs::BeyondSwitch
            }
            None if is_among_knots => {
                if self.is_rough(h, T::ratio(1, 2)) && self.halves_among_knots() {
                    return Ok(Made::Rough);
                }
                EndIs::BeyondSwitch
            }
            None => EndIs::Smooth,
        };
        let outcome = self.inner.complete(h)?;
        let estimate = self.estimate(h, end_is == EndIs::OnSwitch);
        Ok(Made::Step(outcome, estimate, end_is))
    }

    fn halves_among_knots(&mut self) -> bool {
        let crossings = self.crossings.as_mut();
        crossings.is_some_and(Crossings::halves_among_knots)
    }

    /// Whether kinks within the step of size `h` just made, the first of them at `root`, are more than the
    /// tolerance allows.
    fn is_rough(&mut self, h: T, root: T) -> bool {
        let rho = self.estimate(h, false).decay;
        let core = &mut self.inner.core;
        match (&mut self.roughness, &mut self.crossings) {
            (Some(roughness), Some(crossings)) => {
                let (path, decay) = (&mut crossings.path, (&self.decay, rho));
                !(roughness.of_step(core, path, (h, root), decay) <= 1.0)
            }
            _ => true,
        }
    }

    /// A step of `size`, that ends on a switch, if time resolves it; not beyond `end`.
    fn place_of_switch(&self, size: T, end: Option<T>) -> Option<Place<T>> {
        let left = end.map(|end| {
            self.inner
                .direction
                .signed((end - self.time()) - self.time_low)
        });
        if let Some(left) = left.filter(|&left| size >= left) {
            return Some(self.place(left.to_f64(), end));
        }
        let resolved = T::int(RESOLVED) * T::EPSILON * self.time().abs();
        (size > resolved).then(|| self.step_to(size, true))
    }

    fn stop_aiming(&mut self) {
        self.crossings.iter_mut().for_each(Crossings::stop_aiming);
    }

    /// A step of size `h` is accepted. That it was cut at a switch says nothing against the size `proposed`.
    fn accept_crossing(&mut self, end_is: EndIs, (h, proposed): (f64, f64)) {
        let Some(crossings) = &mut self.crossings else {
            return;
        };
        let is_on_switch = end_is == EndIs::OnSwitch;
        crossings.accept((end_is != EndIs::Smooth, is_on_switch));
        if is_on_switch {
            let next = &mut self.control.memory.next;
            if *next >= h {
                *next = proposed.max(h);
            }
            let crossed = crossings.met();
            if let Some(steps) = &mut self.inner.variable {
                steps.switches_crossed += crossed;
            }
        }
    }

    /// The estimate of the step of size `h` just made.
    fn estimate(&mut self, h: T, ends_on_switch: bool) -> Estimate {
        let Stepper { core, y, next, .. } = &mut self.inner;
        let crossings = self.crossings.as_mut();
        let begins_on_switch = crossings.as_ref().is_some_and(|c| c.begins_on_one());
        let on_switch = [begins_on_switch, ends_on_switch];
        core.counts_mut().gradients += 1;
        if !ends_on_switch {
            core.energy_mut().gradient(&next.hi, &mut self.slopes[1]);
        }
        if let Some(crossings) = crossings.filter(|_| begins_on_switch || ends_on_switch) {
            crossings.path.take_polynomial(core, y);
            core.counts_mut().gradients += u64::from(begins_on_switch);
            let inset = self.decay.inset();
            let places = [inset, T::int(1) - inset];
            for ((place, is_on), slope) in places.into_iter().zip(on_switch).zip(&mut self.slopes) {
                if is_on {
                    core.energy_mut()
                        .gradient(crossings.path.state_at(place), slope);
                }
            }
        }
        let [start, end] = &self.slopes;
        let ends = [(start, begins_on_switch), (end, ends_on_switch)];
        let ends = ends.map(|(slope, is_inset)| End { slope, is_inset });
        let l = core.derivatives_by_component();
        self.decay.estimate((y, h), l, ends)
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
    fn place(&self, size: f64, end: Option<T>) -> Place<T> {
        let h = T::exact(size);
        let (now, low) = (self.time(), self.time_low);
        if let Some(end) = end {
            let left = self.inner.direction.signed((end - now) - low);
            let zero = T::int(0);
            let allowed = left <= h || left.to_f64() <= self.control.most;
            if left <= h + h / T::int(STRETCH) && allowed {
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

    fn step_to(&self, size: T, cut: bool) -> Place<T> {
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
        self.tries = TRIES_FOR_FIRST;
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

    /// Begins a new run at (`q0`, `p0`), each of length m, at time `t0`; see [`Stepper::restart`].
    ///
    /// # Errors
    /// Faults of the initial values, and an H that is not finite there.
    pub fn restart(&mut self, q0: &[T], p0: &[T], t0: T) -> Result<(), IntegrateError<T>> {
        self.begin_at((q0, p0), t0, None)
    }

    pub(super) fn begin_at(
        &mut self,
        start: (&[T], &[T]),
        t0: T,
        towards: Option<T>,
    ) -> Result<(), IntegrateError<T>> {
        self.inner.start_at(start, t0, towards)?;
        self.take_slope();
        self.crossings.iter_mut().for_each(Crossings::begin);
        (self.time_low, self.end) = (T::int(0), None);
        let [first, longest] = match self.first_step {
            Some(h) => [h.to_f64(); 2],
            None => {
                let Stepper { core, y, .. } = &mut self.inner;
                self.first.sizes(core.energy_mut(), &y.hi)
            }
        };
        self.longest_first = longest;
        // Time resolves no shorter step.
        let resolved = (T::int(RESOLVED) * T::EPSILON * t0.abs()).to_f64();
        self.control.begin(first.max(resolved));
        self.tries = match self.first_step {
            Some(_) => TRIES_FOR_FIRST,
            None => 0,
        };
        self.inner.variable = Some(VariableSteps::new(self.tolerance));
        Ok(())
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
        T::exact(self.control.memory.next)
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

impl<T: Float, E: Evaluate<T>> Iterator for AdaptiveStepper<T, E> {
    type Item = Result<Step<T>, IntegrateError<T>>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(self.advance().map(|view| view.to_step()))
    }
}
