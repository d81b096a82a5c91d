//! [`AdaptiveSteps`]: step sizes by a tolerance.
//!
//! Every step: solve at the proposed size → estimate → accept, or reject and try a better size from the same
//! state. The stages of a rejected step are the initial guess of the next attempt. Time is summed with
//! compensation.
//!
//! If a step would begin a series of uncorrected steps, it is repeated with half the size, down to a small
//! part of the proposed size; the next step is not longer (docs/adr/0035).
//!
//! A step that crosses a switch of H (a discontinuity of H or of a derivative) is replaced by a shorter one
//! that ends on the switch ([`super::over_switches`]).

use crate::control::controller::Control;
use crate::control::estimate::Decay;
use crate::control::first_step::FirstSize;
use crate::control::flow::Flow;
use crate::control::policy::{MOST_TRIES, PART};
use crate::control::stuck::{TooSmall, shortest_at};
use crate::error::IntegrateError;
use crate::events::crossings::Crossings;
use crate::report::entries::VariableSteps;
use crate::steppers::integration::Integration;
use crate::steppers::sizes::made::{EndIs, Made, Place};
use equip_scalar::Float;
use equip_solver::Outcome;

/// Step control by a tolerance, with its memory.
#[derive(Debug)]
pub(crate) struct AdaptiveSteps<T: Float> {
    pub(super) control: Control,
    pub(super) decay: Decay<T>,
    pub(super) flow: Flow<T>,
    /// ∇H at the start and at the end of the step.
    pub(super) gradients: [Vec<T>; 2],
    /// The rounding error of ∇H at the end of a step, if it was computed.
    pub(super) gradient_rounding: Vec<T>,
    /// Workspace for a direction and its product with ∇²H.
    pub(super) products: [Vec<T>; 2],
    /// `None` if H is smooth, as far as is known.
    pub(super) crossings: Option<Crossings<T>>,
    /// Whether the trace of H tells that it is smooth.
    pub(super) is_smooth: bool,
    pub(super) first: FirstSize<T>,
    pub(super) first_step: Option<T>,
    /// The largest size of the first step.
    pub(super) longest_first: f64,
    pub(super) tolerance: T,
    /// The rounding remainder of the time.
    pub(super) time_low: T,
    /// The end of the run, if it is known.
    pub(super) end: Option<T>,
    pub(super) min_step: T,
    pub(super) max_steps: u64,
    /// The number of attempts of the first step; `None` once its size is final.
    pub(super) tries: Option<u32>,
}

impl<T: Float> AdaptiveSteps<T> {
    /// Makes the next step, but not beyond `end`. The last step ends exactly at `end`.
    pub(super) fn advance_within(
        &mut self,
        run: &mut Integration<T>,
        end: Option<T>,
    ) -> Result<(), IntegrateError<T>> {
        if run.core.counts().steps >= self.max_steps {
            let (steps, time) = (self.max_steps, run.time);
            return Err(IntegrateError::StepLimit { steps, time });
        }
        let mut size = self.control.next;
        // Near t = 0 time resolves steps of any size. No motion changes its scale by 1/ε² within a step. The
        // first size may be any number, since a tiny force turns the motion late: the interval limits it.
        let largest = self.place(run, size, end).size.min(T::exact(size));
        let least = self.min_step.max(largest * T::EPSILON * T::EPSILON);
        if self.is_smooth {
            self.decay.from_zero = largest * T::EPSILON.sqrt().sqrt();
        }
        // `proposed` is the size without regard to switches, `longest` the largest next size after knots or
        // an uncorrected attempt.
        let (mut proposed, mut longest) = (size, f64::INFINITY);
        let (mut cause, mut is_retried) = (None, false);
        let was_corrected = !run.last.1.is_uncorrected();
        let possible = self.min_step.max(shortest_at(run.time)).to_f64();
        let shortest = (size / PART as f64).max(2.0 * possible);
        if let Some(crossings) = &mut self.crossings {
            crossings.begin_step();
        }
        let mut to_switch = None;
        loop {
            let place = to_switch
                .take()
                .unwrap_or_else(|| self.place(run, size, end));
            let too_small = !run.direction.is_before(run.time, place.time)
                || (place.size < least && !place.cut);
            if too_small {
                return Err(self.too_small(run, place.size, cause));
            }
            let h = place.size.to_f64();
            let made = match self.make_up_to_switches(run, place, end) {
                Ok(made) => made,
                Err(error) if fails_in_shorter_steps(&error) => return Err(error),
                Err(error) => {
                    (size, cause) = (h / 2.0, Some(error));
                    proposed = size;
                    count(run, |steps| &mut steps.failed);
                    self.tries = None;
                    self.stop_aiming();
                    continue;
                }
            };
            // The step is accepted, or repeated with another size.
            let mut tries = None;
            match made {
                Made::OverSwitch(shorter) => to_switch = Some(shorter),
                Made::OverKnots => {
                    size = h / 2.0;
                    longest = size;
                }
                Made::Step(outcome, _, EndIs::Smooth)
                    if was_corrected
                        && may_be_corrected(outcome)
                        && run.core.has_made_errors()
                        && h > shortest
                        && !place.cut =>
                {
                    (size, cause) = (h / 2.0, None);
                    (proposed, longest) = (size, size);
                    count(run, |steps| &mut steps.failed);
                }
                Made::Step(outcome, estimate, end_is) => {
                    let contraction = run.core.contraction();
                    let limits = (contraction, self.longest_first);
                    if let Some(made) = self.tries.filter(|&tries| tries < MOST_TRIES)
                        && !place.cut
                        && end_is == EndIs::Smooth
                        && let Some(longer) = self.control.first_is_timid(h, &estimate, limits)
                    {
                        (size, tries) = (longer, Some(made + 1));
                    } else if let Some(shorter) =
                        (self.control).judge(h, &estimate, (contraction, is_retried))
                    {
                        (size, cause) = (shorter, None);
                        proposed = size;
                        count(run, |steps| &mut steps.rejected);
                    } else {
                        run.check_domains(run.direction.signed(place.size))?;
                        self.accept(run, place, outcome);
                        self.accept_switches(run, end_is, (h, proposed));
                        self.control.next = self.control.next.min(longest);
                        return Ok(());
                    }
                }
            }
            (self.tries, is_retried) = (tries, true);
            run.core.refuse();
            if to_switch.is_none() {
                self.stop_aiming();
            }
        }
    }

    /// The error if no step of this `size` is possible.
    fn too_small(
        &mut self,
        run: &mut Integration<T>,
        size: T,
        cause: Option<IntegrateError<T>>,
    ) -> IntegrateError<T> {
        let too_small = TooSmall {
            time: run.time,
            h: run.direction.signed(size),
            min: self.min_step,
            tolerance: self.tolerance,
        };
        let start = run.start_state();
        let Integration { core, y, .. } = run;
        too_small.error(core.energy_mut(), (&start, &y.hi), cause)
    }

    /// Computes ∇H at the start of the next step.
    pub(super) fn take_gradient(&mut self, run: &mut Integration<T>) {
        let Integration { core, y, .. } = run;
        core.energy_mut()
            .flow_gradient(&y.hi, &mut self.gradients[0]);
    }

    /// The end of a step of this size. Near `end`, the step ends at `end` or covers half of the remainder, so
    /// that no very short step is left.
    pub(super) fn place(&self, run: &Integration<T>, size: f64, end: Option<T>) -> Place<T> {
        let h = T::exact(size);
        let (now, low) = (run.time, self.time_low);
        if let Some(end) = end {
            let left = run.direction.signed((end - now) - low);
            let zero = T::int(0);
            // A step may be stretched slightly to meet the end.
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
                return self.step_to(run, left / T::int(2), true);
            }
        }
        self.step_to(run, h, false)
    }

    pub(super) fn step_to(&self, run: &Integration<T>, size: T, cut: bool) -> Place<T> {
        let (sum, lost) = T::two_sum(run.time, run.direction.signed(size));
        let (time, time_low) = T::two_sum(sum, lost + self.time_low);
        Place {
            size,
            time,
            time_low,
            cut,
        }
    }

    fn accept(&mut self, run: &mut Integration<T>, place: Place<T>, outcome: Outcome) {
        self.tries = None;
        self.time_low = place.time_low;
        if let Some(steps) = &mut run.measured.variable {
            steps.largest = steps.largest.max(place.size);
            if !place.cut || steps.smallest > steps.largest {
                steps.smallest = steps.smallest.min(place.size);
            }
        }
        let h = run.direction.signed(place.size);
        run.accept(place.time, h, outcome);
        self.gradients.swap(0, 1);
    }
}

fn count<T: Float>(run: &mut Integration<T>, which: impl Fn(&mut VariableSteps<T>) -> &mut u64) {
    if let Some(steps) = &mut run.measured.variable {
        *which(steps) += 1;
    }
}

/// Whether a shorter step may conserve the energy, which this one does not.
fn may_be_corrected(outcome: Outcome) -> bool {
    outcome.is_uncorrected() && outcome != Outcome::Unresolved
}

/// Whether a shorter step would fail for the same reason.
fn fails_in_shorter_steps<T: Float>(error: &IntegrateError<T>) -> bool {
    matches!(
        error,
        IntegrateError::NoAdmissibleAlpha { .. } | IntegrateError::WrongGradient { .. }
    )
}
