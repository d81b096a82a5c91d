//! Runs by a tolerance at switches of H ([`crate::events::crossings`]). A step that crosses a switch is
//! repeated so that it ends on the switch, unless the effect of the discontinuity is below the tolerance
//! ([`crate::events::roughness`]).
//!
//! The α_k of a step are computed once it is known that the step is not repeated. If a step begins or ends on
//! a switch, the derivative is evaluated slightly within the step, where H is that of one side.

use crate::control::estimate::{End, Estimate};
use crate::control::policy::{ROUNDING, SOON};
use crate::control::stuck::shortest_at;
use crate::error::IntegrateError;
use crate::events::crossings::{Crossings, Meeting};
use crate::steppers::integration::Integration;
use crate::steppers::sizes::adaptive_steps::AdaptiveSteps;
use crate::steppers::sizes::made::{EndIs, Made, Place};
use equip_scalar::Float;
use equip_solver::Core;

impl<T: Float> AdaptiveSteps<T> {
    /// Attempts a step and its estimate, or only its stages if the step must end earlier, on a switch.
    pub(super) fn make_up_to_switches(
        &mut self,
        run: &mut Integration<T>,
        place: Place<T>,
        end: Option<T>,
    ) -> Result<Made<T>, IntegrateError<T>> {
        let h = run.direction.signed(place.size);
        let outcome = run.attempt(h)?;
        let Integration { core, y, next, .. } = run;
        let Some(crossings) = &mut self.crossings else {
            return Ok(Made::Step(
                outcome,
                self.estimate(run, h, false),
                EndIs::Smooth,
            ));
        };
        let was_aimed = crossings.is_aimed();
        let meeting = crossings.look(core, y, next);
        // A switch beyond the end of the run does not count.
        let is_last = end == Some(place.time);
        let meeting = meeting.filter(|meeting| match meeting {
            Meeting::At(root, _) => *root <= T::int(1) || !is_last,
            Meeting::End | Meeting::Touch(_) | Meeting::Missed => true,
        });
        let end_is = match meeting {
            Some(Meeting::End) => EndIs::OnSwitch,
            Some(Meeting::At(root, next)) => {
                let is_rough = was_aimed
                    || self.jumps_at(run, root)
                    || self.is_rough(run, h, [root, next.unwrap_or(root)]);
                let is_soon = T::int(SOON) * root < T::int(1);
                if is_rough && is_soon && !was_aimed && self.may_halve() {
                    return Ok(Made::OverKnots);
                }
                if is_rough && let Some(shorter) = self.place_of_switch(run, place.size * root, end)
                {
                    return Ok(Made::OverSwitch(shorter));
                }
                EndIs::BeyondSwitch
            }
            Some(Meeting::Touch(near)) => {
                if let Some(shorter) = self.place_of_switch(run, place.size * near, end) {
                    return Ok(Made::OverSwitch(shorter));
                }
                EndIs::Smooth
            }
            Some(Meeting::Missed) => EndIs::BeyondSwitch,
            None if crossings.is_among_knots => {
                if self.is_rough(run, h, [T::ratio(1, 2); 2]) && self.may_halve() {
                    return Ok(Made::OverKnots);
                }
                EndIs::BeyondSwitch
            }
            None => EndIs::Smooth,
        };
        let outcome = run.complete(h)?;
        let estimate = self.estimate(run, h, end_is == EndIs::OnSwitch);
        Ok(Made::Step(outcome, estimate, end_is))
    }

    /// Whether the effect of discontinuities within the last step, of size `h`, exceeds the tolerance.
    /// `roots` are the first two.
    fn is_rough(&mut self, run: &mut Integration<T>, h: T, roots: [T; 2]) -> bool {
        let rho = self.estimate(run, h, false).decay;
        let Integration { core, next, .. } = run;
        let (rounding, room) = (&mut self.gradient_rounding, &mut self.products);
        take_rounding(core, (&next.hi, h), rounding, room);
        let decay = (&self.decay, rho, &rounding[..]);
        let crossings = self.crossings.as_mut();
        crossings.is_some_and(|crossings| crossings.is_rough(core, (h, roots), decay))
    }

    /// Whether H jumps at the first switch that the last step meets.
    fn jumps_at(&mut self, run: &mut Integration<T>, root: T) -> bool {
        let core = &mut run.core;
        let crossings = self.crossings.as_mut();
        crossings.is_some_and(|crossings| crossings.jump_at(core, root).is_some())
    }

    /// Whether a step across knots is to be halved once more.
    fn may_halve(&mut self) -> bool {
        let crossings = self.crossings.as_mut();
        crossings.is_some_and(Crossings::may_halve)
    }

    /// A step of `size` that ends on a switch, if time resolves it; not beyond `end`.
    fn place_of_switch(&self, run: &Integration<T>, size: T, end: Option<T>) -> Option<Place<T>> {
        let direction = run.direction;
        let left = end.map(|end| direction.signed((end - run.time) - self.time_low));
        if let Some(left) = left.filter(|&left| size >= left) {
            return Some(self.place(run, left.to_f64(), end));
        }
        (size > shortest_at(run.time)).then(|| self.step_to(run, size, true))
    }

    pub(super) fn stop_aiming(&mut self) {
        self.crossings.iter_mut().for_each(Crossings::stop_aiming);
    }

    /// Accepts a step of size `h`. If it was shortened to end on a switch, the size `proposed` is not
    /// reduced.
    pub(super) fn accept_switches(
        &mut self,
        run: &mut Integration<T>,
        end_is: EndIs,
        (h, proposed): (f64, f64),
    ) {
        let Some(crossings) = &mut self.crossings else {
            return;
        };
        let is_on_switch = end_is == EndIs::OnSwitch;
        crossings.accept((end_is != EndIs::Smooth, is_on_switch));
        if is_on_switch || crossings.has_touched {
            let next = &mut self.control.next;
            if *next >= h {
                *next = proposed.max(h);
            }
        }
        if is_on_switch {
            let jump = crossings.jump(&mut run.core);
            run.measured.cross(crossings.met(), jump);
        }
    }

    /// The error estimate of the last step, of size `h`.
    fn estimate(&mut self, run: &mut Integration<T>, h: T, ends_on_switch: bool) -> Estimate {
        let Integration { core, y, next, .. } = run;
        let crossings = self.crossings.as_mut();
        let begins_on_switch = crossings.as_ref().is_some_and(|c| c.begins_on_one());
        let on_switch = [begins_on_switch, ends_on_switch];
        core.counts_mut().gradients += 1 + u64::from(begins_on_switch);
        if !ends_on_switch {
            core.energy_mut()
                .flow_gradient(&next.hi, &mut self.gradients[1]);
        }
        if let Some(crossings) = crossings.filter(|_| on_switch.contains(&true)) {
            crossings.path.take_polynomial(core, y);
            let inset = self.decay.inset();
            let places = [inset, T::int(1) - inset];
            for ((place, is_on), gradient) in
                places.into_iter().zip(on_switch).zip(&mut self.gradients)
            {
                if is_on {
                    let y = crossings.path.state_at(place);
                    core.energy_mut().flow_gradient(y, gradient);
                }
            }
        }
        let [start, end] = &self.gradients;
        let ends = [(start, begins_on_switch), (end, ends_on_switch)];
        let ends = ends.map(|(gradient, is_inset)| End { gradient, is_inset });
        let l = core.derivatives_by_component();
        let mut estimate = self.decay.estimate((y, h), l, ends, None);
        if !ends_on_switch && self.control.is_too_long(&estimate) {
            take_rounding(
                core,
                (&next.hi, h),
                &mut self.gradient_rounding,
                &mut self.products,
            );
            let l = core.derivatives_by_component();
            estimate = self
                .decay
                .estimate((y, h), l, ends, Some(&self.gradient_rounding));
        }
        let rho = estimate.decay;
        // The flow is not estimated from rounding, nor if the contraction bounds it well enough.
        let is_rounding = self.decay.is_rounding(&estimate);
        let is_needed = core.contraction().is_none_or(|contraction| {
            let most = self.decay.with_flow(rho, self.flow.most(contraction));
            !self.control.has_room(most, contraction)
        });
        if is_needed && !is_rounding {
            let (energy, counts) = core.energy_and_counts();
            counts.gradients += 2;
            let flow = self.flow.decay(energy, (&y.hi, h), &self.decay);
            estimate.decay = self.decay.with_flow(rho, flow);
        }
        estimate
    }
}

/// Writes the rounding error of ∇H at the end `y` of a step of size `h` to `rounding`: of its operations, and
/// of the stages, which carry the rounding of the forces that move them. The estimate takes [`ROUNDING`]
/// times the former, and the latter once. `products` is workspace.
fn take_rounding<T: Float>(
    core: &mut Core<T>,
    (y, h): (&[T], T),
    rounding: &mut [T],
    [moved, product]: &mut [Vec<T>; 2],
) {
    let (energy, counts) = core.energy_and_counts();
    counts.gradients += 3;
    energy.gradient_rounding(y, rounding);
    let half = y.len() / 2;
    for (c, moved) in moved.iter_mut().enumerate() {
        *moved = h.abs() * rounding[(c + half) % y.len()];
    }
    energy.hessian_vector(y, moved, product);
    for (rounding, product) in rounding.iter_mut().zip(&*product) {
        *rounding += product.abs() / T::int(ROUNDING);
    }
}
