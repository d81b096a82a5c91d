//! The α's of a step whose stages are solved with α = 0 and whose constraints are not at their floors.
//!
//! 1. α = D t with t from the constraints, D of [`crate::alpha::direction`] at the stages as they are; Z
//!    follows, and is iterated to rest.
//! 2. The same from the new stages, until the constraints are at their floors.
//! 3. D is taken anew at the solution, and t with it, until that moves the end point by rounding only: α =
//!    D(Z) t then. With no more α's than constraints (s = 2) D is I, and taken once for its slopes.
//!
//! *Admissible* (project note, section 8). The step resolves its fastest motion, hω ≤ s; |α_k| is within its
//! bound; and the end point is within [`FARTHEST`] times the displacement that the step's own defect is worth
//! at least, and 1/[`SMALL`] of the motion, each component in units of its motion, or moved by rounding.
//! Otherwise the step with α = 0 stands, and its defect is carried.

use crate::alpha::progress::{Bounds, Progress, direction_tolerance};
use crate::equations::constraint::Constraint;
use crate::options::step_options::Reach;
use crate::outcome::failure::Failure;
use crate::outcome::outcome::Outcome;
use crate::policy::{FARTHEST, MOST_STALLS, SMALL, STALLED, STATE_ROUNDING, TURNS};
use crate::step::core::{AlphaSolver, Core};
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
        // Without α's that are free there are no constraints.
        let Some(mut solver) = self.alpha_solver.take() else {
            return Err(Failure::NoAlpha);
        };
        self.stages.iterate.keep_momenta(y);
        self.stages.iterate.keep(&mut solver.kept);
        solver.unperturbed.copy_from(next);
        let noise = self.stages.contraction.noise();
        let moved = self.move_alphas(&mut solver, (y, h), next);
        if moved.is_err() {
            self.alphas.copy_from_slice(&self.start_alphas);
            self.stages.iterate.put_back(&solver.kept);
            next.copy_from(&solver.unperturbed);
        }
        self.alpha_solver = Some(solver);
        let reason = match moved {
            Ok(()) => return Ok(Outcome::Solved),
            Err(reason) => reason,
        };
        self.evaluate_constraints(next, noise)?;
        // What no α's bring down near the floors is rounding.
        if self.in_late_floors() <= T::int(STALLED) {
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
    fn move_alphas(
        &mut self,
        solver: &mut AlphaSolver<T>,
        (y, h): (&State<T>, T),
        next: &mut State<T>,
    ) -> Result<(), Outcome> {
        let mut bounds = self.bounds(solver, (y, h), next)?;
        let rounding = T::int(STATE_ROUNDING) * T::EPSILON;
        let mut progress = Progress::<T>::new();
        // A direction that turns faster than it comes to rest is kept as it is.
        let mut turns_left = T::MANTISSA_BITS / TURNS.ilog2();
        for moves in 0..=MOST_ITERATIONS {
            let turns = progress.turns();
            let has_choice = solver.direction.has_choice();
            let is_kept =
                turns.is_some_and(|turns| !has_choice || turns <= rounding) || turns_left == 0;
            if !is_kept {
                turns_left -= 1;
                self.stages.iterate.keep_momenta(y);
                let tolerance = match turns {
                    None => bounds.tolerance,
                    Some(turns) => {
                        self.linearise(solver)?;
                        let far = progress.farthest.max(T::int(4) * bounds.needed);
                        direction_tolerance(turns, far)
                    }
                };
                self.take_direction(solver, (y, next), tolerance)?;
                progress.direction_taken(tolerance);
            }
            if !solver.direction.aim(&self.alphas, &self.constraints) {
                return Err(Outcome::NoSlope);
            }
            let [of_stages, of_state] = solver.direction.displacement();
            let floors = self.in_late_floors();
            let is_settled = of_state <= rounding || moves > 0 && is_kept;
            if is_settled && floors <= T::int(1) {
                return Ok(());
            }
            // What no longer shrinks is rounding near the floor, and hopeless elsewhere.
            let stalls = progress.stalls(floors, of_state);
            if stalls > 0 && floors <= T::int(STALLED) {
                return Ok(());
            }
            if stalls > MOST_STALLS || moves == MOST_ITERATIONS {
                break;
            }
            progress.moves(of_stages, of_state);
            self.move_once(solver, (y, h), next)?;
            solver.direction.learn(&self.constraints);
            self.check_displacement(solver, (y, h), next, &mut bounds)?;
        }
        Err(Outcome::NoSlope)
    }

    /// The farthest that the end point may be moved. An error if no α's that stay within it can keep the
    /// constraints.
    fn bounds(
        &mut self,
        solver: &mut AlphaSolver<T>,
        step: (&State<T>, T),
        next: &State<T>,
    ) -> Result<Bounds<T>, Outcome> {
        solver.direction.begin(&self.stages.iterate, step.0, next);
        let direction = &solver.direction;
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
        let mut bounds = Bounds {
            needed: needed[0],
            tolerance: direction_tolerance(needed[0], T::int(4) * needed[0]),
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
        if !is_rounding && !bounds.is_small(needed) {
            return Err(Outcome::TooFar);
        }
        self.linearise(solver)?;
        if !is_free && !solver.direction.is_resolved() {
            return Err(Outcome::Unresolved);
        }
        if is_rounding || bounds.holds(needed) || self.extend(solver, step, &mut bounds, needed) {
            Ok(bounds)
        } else {
            Err(Outcome::TooFar)
        }
    }

    /// Estimates the local error, once in a step. Returns whether the end point may be moved so `far` by it.
    fn extend(
        &mut self,
        solver: &mut AlphaSolver<T>,
        step: (&State<T>, T),
        bounds: &mut Bounds<T>,
        far: [T; 2],
    ) -> bool {
        if !bounds.is_small(far) || std::mem::replace(&mut bounds.has_error, true) {
            return false;
        }
        if let Some(local_error) = &mut solver.local_error {
            let l = (solver.kept.increments(), self.stages.iterate.stride());
            let counts = &mut self.counts;
            counts.local_errors += 1;
            let units = &solver.direction.motion;
            let error = local_error.estimate(&mut self.energy, step, l, units, counts);
            for (most, error) in bounds.most.iter_mut().zip(error.unwrap_or([T::int(0); 2])) {
                *most = most.max(T::int(FARTHEST) * error);
            }
        }
        bounds.holds(far)
    }

    fn linearise(&mut self, solver: &mut AlphaSolver<T>) -> Result<(), Outcome> {
        let iterate = &self.stages.iterate;
        self.counts.hessians += iterate.stages() as u64;
        let is_finite = solver.direction.linearise(iterate, &mut self.energy);
        is_finite.then_some(()).ok_or(Outcome::NoSlope)
    }

    fn take_direction(
        &mut self,
        solver: &mut AlphaSolver<T>,
        (y, next): (&State<T>, &State<T>),
        tolerance: T,
    ) -> Result<(), Outcome> {
        let (direction, iterate) = (&mut solver.direction, &self.stages.iterate);
        direction.weigh(iterate, y, next);
        self.counts.directions += 1;
        let of = (iterate, self.constraints.as_slice());
        let is_taken = direction.take(of, tolerance, self.stages.choice.operator());
        is_taken.then_some(()).ok_or(Outcome::NoSlope)
    }

    /// Moves the α's, lets Z follow and iterates it to rest.
    fn move_once(
        &mut self,
        solver: &AlphaSolver<T>,
        (y, h): (&State<T>, T),
        next: &mut State<T>,
    ) -> Result<(), Outcome> {
        for (alpha, &delta) in self.alphas.iter_mut().zip(&solver.direction.delta) {
            *alpha += delta;
        }
        let bound = self.options.alpha_bound;
        if !self.alphas.iter().all(|alpha| alpha.abs() <= bound) {
            return Err(Outcome::BeyondBound);
        }
        self.counts.alpha_moves += 1;
        let stages = &mut self.stages;
        stages.iterate.set_alphas(&self.alphas);
        solver.direction.follow(&mut stages.iterate, y);
        stages.contraction.disturb();
        let solved = stages.iterate_to_rest(&mut self.energy, (y, h), &mut self.counts);
        solved.map_err(|_| Outcome::BeyondBound)?;
        stages.iterate.end_point(y, next);
        self.evaluate_constraints(next, self.stages.contraction.noise())
            .map_err(|_| Outcome::BeyondBound)
    }

    /// The largest defect in its floors of late.
    fn in_late_floors(&self) -> T {
        let defects = self.constraints.iter().map(Constraint::in_late_floors);
        defects.fold(T::int(0), |most, floors| most.max(floors))
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

    /// Whether the end point is within bounds of the one with α = 0, but for rounding.
    fn check_displacement(
        &mut self,
        solver: &mut AlphaSolver<T>,
        step: (&State<T>, T),
        next: &State<T>,
        bounds: &mut Bounds<T>,
    ) -> Result<(), Outcome> {
        let rounding = T::int(FARTHEST * STATE_ROUNDING) * T::EPSILON;
        let mut far = [T::int(0); 2];
        let ends = next.hi.iter().zip(&solver.unperturbed.hi);
        for (c, (&end, &before)) in ends.enumerate() {
            let moved = (end - before).abs();
            if moved > rounding * end.abs() {
                for (far, units) in far.iter_mut().zip(&solver.direction.motion) {
                    *far = far.max(moved / units[c]);
                }
            }
        }
        if bounds.holds(far) || self.extend(solver, step, bounds, far) {
            Ok(())
        } else {
            Err(Outcome::TooFar)
        }
    }
}
