//! The α's of a step whose stages are solved with α = 0 and whose constraints are not at their floors.
//!
//! 1. α = D t with t from the constraints, D of [`crate::alpha::direction`] at the stages as they are; Z
//!    follows, and is iterated to rest.
//! 2. The same from the new stages, until the constraints are at their floors.
//! 3. D is taken anew at the solution, and t with it, until that moves the end point by rounding only: α =
//!    D(Z) t then.
//!
//! *Admissible* (project note, section 8). The step resolves its fastest motion, hω ≤ s; |α_k| is within its
//! bound; and the end point is within [`FARTHEST`] times the displacement that the step's own defect is worth
//! at least, and 1/[`SMALL`] of the motion, each component in units of its motion, or moved by rounding.
//! Otherwise the step with α = 0 stands, and its defect is carried.

use crate::alpha::direction::Direction;
use crate::equations::constraint::Constraint;
use crate::options::step_options::Reach;
use crate::outcome::failure::Failure;
use crate::outcome::outcome::Outcome;
use crate::policy::{FARTHEST, MOST_STALLS, SMALL, STALLED, STATE_ROUNDING, TURNS};
use crate::step::core::Core;
use equip_autodiff::Evaluate;
use equip_scalar::Float;
use equip_sweeps::{MOST_ITERATIONS, State};

impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// Solves for the α's, or puts the stages with α = 0 back. `next` is the end point, before and after.
    pub(crate) fn keep_constraints(
        &mut self,
        (y, h): (&State<T>, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        self.stages.iterate.keep_momenta(y);
        self.stages.iterate.keep(&mut self.kept);
        self.unperturbed.copy_from(next);
        let noise = self.stages.contraction.noise();
        let reason = match self.move_alphas((y, h), next) {
            Ok(()) => return Ok(Outcome::Solved),
            Err(reason) => reason,
        };
        self.alphas.copy_from_slice(&self.start_alphas);
        self.stages.iterate.put_back(&self.kept);
        next.copy_from(&self.unperturbed);
        self.evaluate_constraints(next, noise)?;
        // What no α's bring down near the floors is rounding.
        let worst = |most: T, c: &Constraint<T>| most.max(c.in_late_floors());
        if self.constraints.iter().fold(T::int(0), worst) <= T::int(STALLED) {
            return Ok(Outcome::AtFloor);
        }
        // A defect beyond the energy itself is that of a solution which does not follow the motion.
        if let Some(energy) = self.energy_constraint() {
            let sizes = self.stages.iterate.scale();
            let (defect, scale) = (energy.defect, energy.start_scale(sizes));
            if defect.abs() > scale {
                return Err(Failure::Astray { defect, scale });
            }
        }
        if self.options.reach == Reach::Refuse {
            return Err(Failure::NoAlpha);
        }
        Ok(reason)
    }

    /// Moves the α's until the constraints are at their floors; an error is the reason why there are no such
    /// α's.
    ///
    /// A direction turns with the stages, by the share that these move: it is taken anew unless that is worth
    /// less than rounding, and to the digits that show in the end point.
    fn move_alphas(&mut self, (y, h): (&State<T>, T), next: &mut State<T>) -> Result<(), Outcome> {
        let mut reach = self.reach((y, h), next)?;
        let rounding = T::int(STATE_ROUNDING) * T::EPSILON;
        let (mut farthest, mut since) = (T::int(0), T::INFINITY);
        let (mut last, mut stalls) = ([T::INFINITY; 2], 0);
        // A direction that turns faster than it comes to rest is kept as it is.
        let mut turns_left = T::MANTISSA_BITS / TURNS.ilog2();
        for moves in 0..=MOST_ITERATIONS {
            let turns = T::int(TURNS) * farthest * since;
            let is_kept = turns <= rounding || turns_left == 0;
            if !is_kept {
                turns_left -= 1;
                self.stages.iterate.keep_momenta(y);
                // No better than it still turns.
                let digits = if moves == 0 {
                    reach.digits
                } else {
                    digits(turns, farthest.max(T::int(4) * reach.needed))
                };
                if moves > 0 {
                    self.linearise()?;
                }
                self.take_direction((y, next), digits)?;
                since = digits / T::int(TURNS);
            }
            let direction = self.direction.as_mut().ok_or(Outcome::NoSlope)?;
            if !direction.aim(&self.alphas, &self.constraints) {
                return Err(Outcome::NoSlope);
            }
            let [of_stages, of_state] = direction.displacement();
            let worst = |c: T, constraint: &Constraint<T>| c.max(constraint.in_late_floors());
            let floors = self.constraints.iter().fold(T::int(0), worst);
            let shrinks = T::int(2) * floors <= last[0] || T::int(2) * of_state <= last[1];
            let is_near = floors <= T::int(STALLED);
            let is_settled = of_state <= rounding || moves > 0 && is_kept;
            if is_settled && floors <= T::int(1) {
                return Ok(());
            }
            // What no longer shrinks is rounding near the floor, and hopeless elsewhere.
            stalls += u32::from(moves > 1 && !shrinks);
            if stalls > 0 && is_near {
                return Ok(());
            }
            if stalls > MOST_STALLS || moves == MOST_ITERATIONS {
                return Err(Outcome::NoSlope);
            }
            last = [floors, of_state];
            farthest = farthest.max(of_state);
            since += of_stages;
            self.move_once((y, h), next)?;
            if let Some(direction) = &mut self.direction {
                direction.learn(&self.constraints);
            }
            self.check_displacement((y, h), next, &mut reach)?;
        }
        Err(Outcome::NoSlope)
    }

    /// The farthest that the end point may be moved. An error if no α's that stay within it can keep the
    /// constraints.
    fn reach(&mut self, (y, h): (&State<T>, T), next: &State<T>) -> Result<Bounds<T>, Outcome> {
        let direction = self.direction.as_mut().ok_or(Outcome::NoSlope)?;
        direction.begin(&self.stages.iterate, y, next);
        let least = |units: &[T], of: fn(&Constraint<T>) -> T| {
            let worth = |c: &Constraint<T>| c.least_displacement(of(c), units);
            self.constraints
                .iter()
                .fold(T::int(0), |most, c| most.max(worth(c)))
        };
        let units = direction.motion.each_ref();
        let needed = units.map(|units| least(units, |c| c.defect));
        let own = units.map(|units| least(units, |c| c.defect - c.start_defect));
        let is_free = self.options.reach == Reach::Always;
        let mut reach = Bounds {
            needed: needed[0],
            digits: digits(needed[0], T::int(4) * needed[0]),
            most: own.map(|own| {
                if is_free {
                    T::INFINITY
                } else {
                    T::int(FARTHEST) * own
                }
            }),
            small: if is_free {
                T::INFINITY
            } else {
                T::ratio(1, SMALL)
            },
            has_error: is_free,
        };
        let rounding = T::int(STATE_ROUNDING) * T::EPSILON * direction.largest_size(next);
        let is_rounding = needed[0] <= rounding;
        if !is_rounding && !reach.is_small(needed) {
            return Err(Outcome::TooFar);
        }
        self.linearise()?;
        if !is_free && !self.direction.as_mut().is_some_and(Direction::is_resolved) {
            return Err(Outcome::Unresolved);
        }
        if is_rounding || reach.holds(needed) || self.extend((y, h), &mut reach, needed) {
            Ok(reach)
        } else {
            Err(Outcome::TooFar)
        }
    }

    /// Estimates the local error, once in a step. Returns whether the end point may be moved so `far` by it.
    fn extend(&mut self, step: (&State<T>, T), reach: &mut Bounds<T>, far: [T; 2]) -> bool {
        if !reach.is_small(far) || std::mem::replace(&mut reach.has_error, true) {
            return false;
        }
        if let (Some(local_error), Some(direction)) = (&mut self.local_error, &self.direction) {
            let l = (self.kept.increments(), self.stages.iterate.stride());
            let counts = &mut self.counts;
            counts.local_errors += 1;
            let error = local_error.estimate(&mut self.energy, step, l, &direction.motion, counts);
            for (most, error) in reach.most.iter_mut().zip(error.unwrap_or([T::int(0); 2])) {
                *most = most.max(T::int(FARTHEST) * error);
            }
        }
        reach.holds(far)
    }

    fn linearise(&mut self) -> Result<(), Outcome> {
        let direction = self.direction.as_mut().ok_or(Outcome::NoSlope)?;
        self.counts.hessians += self.stages.iterate.stages() as u64;
        if direction.linearise(&self.stages.iterate, &mut self.energy) {
            Ok(())
        } else {
            Err(Outcome::NoSlope)
        }
    }

    fn take_direction(
        &mut self,
        (y, next): (&State<T>, &State<T>),
        tolerance: T,
    ) -> Result<(), Outcome> {
        let direction = self.direction.as_mut().ok_or(Outcome::NoSlope)?;
        direction.weigh(&self.stages.iterate, y, next);
        let m = self.stages.choice.operator();
        let of = (&self.stages.iterate, self.constraints.as_slice());
        self.counts.directions += 1;
        if direction.take(of, tolerance, m) {
            Ok(())
        } else {
            Err(Outcome::NoSlope)
        }
    }

    /// Moves the α's, lets Z follow and iterates it to rest.
    fn move_once(&mut self, (y, h): (&State<T>, T), next: &mut State<T>) -> Result<(), Outcome> {
        let direction = self.direction.as_mut().ok_or(Outcome::NoSlope)?;
        let delta = direction.delta.iter();
        self.alphas
            .iter_mut()
            .zip(delta)
            .for_each(|(alpha, &delta)| *alpha += delta);
        let bound = self.options.alpha_bound;
        if !self.alphas.iter().all(|alpha| alpha.abs() <= bound) {
            return Err(Outcome::BeyondBound);
        }
        self.counts.alpha_moves += 1;
        let stages = &mut self.stages;
        stages.iterate.set_alphas(&self.alphas);
        direction.follow(&mut stages.iterate, y);
        stages.contraction.disturb();
        let solved = stages.iterate_to_rest(&mut self.energy, (y, h), &mut self.counts);
        solved.map_err(|_| Outcome::BeyondBound)?;
        stages.iterate.end_point(y, next);
        self.evaluate_constraints(next, self.stages.contraction.noise())
            .map_err(|_| Outcome::BeyondBound)
    }

    /// Evaluates the constraints at the end point, which the iteration for the stages has left with this
    /// `noise`.
    pub(crate) fn evaluate_constraints(
        &mut self,
        next: &State<T>,
        noise: f64,
    ) -> Result<(), Failure<T>> {
        let noise = T::exact(noise);
        let sizes = self.stages.iterate.scale();
        for constraint in &mut self.constraints {
            self.counts.gradients += 1;
            if !constraint.evaluate(&mut self.energy, next, (noise, sizes)) {
                return Err(Failure::NotFinite);
            }
        }
        Ok(())
    }

    /// Whether the end point is within reach of the one with α = 0, but for rounding.
    fn check_displacement(
        &mut self,
        step: (&State<T>, T),
        next: &State<T>,
        reach: &mut Bounds<T>,
    ) -> Result<(), Outcome> {
        let direction = self.direction.as_ref().ok_or(Outcome::NoSlope)?;
        let rounding = T::int(FARTHEST * STATE_ROUNDING) * T::EPSILON;
        let mut far = [T::int(0); 2];
        for (c, (&end, &before)) in next.hi.iter().zip(&self.unperturbed.hi).enumerate() {
            let moved = (end - before).abs();
            if moved > rounding * end.abs() {
                for (far, units) in far.iter_mut().zip(&direction.motion) {
                    *far = far.max(moved / units[c]);
                }
            }
        }
        if reach.holds(far) || self.extend(step, reach, far) {
            Ok(())
        } else {
            Err(Outcome::TooFar)
        }
    }
}

/// How far the end point has to be moved at least to keep the constraints, and how far it may be, in units of
/// the motion: of each component, and of the one of its group that moves most.
struct Bounds<T> {
    needed: T,
    /// Of the first direction.
    digits: T,
    most: [T; 2],
    /// What is a small share of the motion: what moves further is no correction of a step.
    small: T,
    /// The local error has been asked for.
    has_error: bool,
}

/// The relative tolerance of a direction that turns by so much yet and moves the end point so `far`: what
/// shows in the end point, and no better than it turns.
fn digits<T: Float>(turns: T, far: T) -> T {
    let rounding = T::int(STATE_ROUNDING) * T::EPSILON;
    (rounding / far / T::int(TURNS))
        .max(turns)
        .max(rounding)
        .min(T::ratio(1, 1000))
}

impl<T: Float> Bounds<T> {
    fn is_small(&self, far: [T; 2]) -> bool {
        far.iter().all(|&far| far <= self.small)
    }

    fn holds(&self, far: [T; 2]) -> bool {
        self.is_small(far) && far.iter().zip(&self.most).all(|(far, most)| far <= most)
    }
}
