//! The solution of system (7), given the solution with α = 0. Z and t are iterated together:
//!
//! $$ Z = K(\alpha) L(Z), \qquad \alpha = D\,t, \qquad I(y_1) = I_{ref} . $$
//!
//! 1. D is computed once, at α = 0 ([`crate::alpha::direction`]).
//! 2. t is updated by Newton's method with the derivative along D, then by the secant method. Z is updated by
//!    ∂Z/∂t. The iteration for Z continues with K(α) until its noise is negligible in I(y1), and t is updated
//!    again.
//! 3. Once I is at its round-off level, the iteration for Z continues until it has converged, as for Gauss.
//!
//! If no α is admissible ([`crate::alpha::admissible`]), or the step does not resolve its fastest oscillation
//! (hω > s), the step with α = 0 is accepted. It is *uncorrected*: its energy error is left to a later step.

use crate::alpha::admissible::Bounds;
use crate::constraint::Constraint;
use crate::options::step_options::AlphaPolicy;
use crate::outcome::failure::Failure;
use crate::outcome::outcome::Outcome;
use crate::policy::{FARTHEST, MOST_STALLS, SHARE, STALLED, STATE_ROUNDING};
use crate::step::core::{AlphaSolver, Core};
use equip_iterate::{MOST_ITERATIONS, State};
use equip_scalar::Float;

impl<T: Float> Core<T> {
    /// Solves for α, or restores the stages with α = 0. On entry and on return `next` is y1. The stages have
    /// converged if `is_converged`.
    pub(crate) fn solve_alphas(
        &mut self,
        (y, h): (&State<T>, T),
        next: &mut State<T>,
        is_converged: bool,
    ) -> Result<Outcome, Failure<T>> {
        // Without free parameters there are no constraints.
        let Some(mut solver) = self.alpha_solver.take() else {
            return Err(Failure::NoAlpha);
        };
        self.stages.iterate.keep_momenta(y);
        self.stages.iterate.keep(&mut solver.kept);
        solver.unperturbed.copy_from(next);
        let mut noise = self.stages.contraction.noise();
        let mut bounds = self.bounds(&mut solver, next, y);
        let solved = self.update_alphas(&mut solver, (y, h), next, (&mut bounds, is_converged));
        let has_choice = solver.direction.has_choice();
        solver.handed_on = bounds.hands_on(has_choice, solved.is_ok());
        self.alpha_solver = Some(solver);
        if solved.is_err() {
            self.alphas.copy_from_slice(&self.start_alphas);
            if let Some(solver) = &self.alpha_solver {
                self.stages.iterate.put_back(&solver.kept);
                next.copy_from(&solver.unperturbed);
            }
        }
        let reason = match solved {
            Ok(()) => return Ok(Outcome::Solved),
            Err(reason) => reason,
        };
        if !is_converged {
            self.stages.contraction.disturb();
            self.converge((y, h), next, 0.0)?;
            noise = self.stages.contraction.noise();
        }
        self.evaluate_constraints(next, noise)?;
        // A residual of a few round-off levels that α does not reduce is rounding.
        if self.in_late_levels() <= T::int(STALLED) {
            return Ok(Outcome::AtRoundOff);
        }
        if self.options.alpha_policy == AlphaPolicy::Refuse {
            return Err(Failure::NoAlpha);
        }
        Ok(reason)
    }

    /// The joint iteration. An error states why there is no admissible α.
    fn update_alphas(
        &mut self,
        solver: &mut AlphaSolver<T>,
        (y, h): (&State<T>, T),
        next: &mut State<T>,
        (bounds, mut is_converged): (&mut Bounds<T>, bool),
    ) -> Result<(), Outcome> {
        self.linearise(solver, (y, h), next, bounds)?;
        self.compute_direction(solver, bounds)?;
        let (mut last, mut stalls) = (T::INFINITY, 0);
        for _ in 0..=MOST_ITERATIONS {
            // The residuals must exceed the noise of Z before they are used to update t.
            let noise = self.stages.contraction.noise();
            let is_noisy = !is_converged && noise > 10.0 * self.noise_allowed(SHARE);
            let level = self.in_late_levels();
            let is_done = is_noisy || level <= T::int(1) || stalls > 1 && level <= T::int(STALLED);
            if is_done && is_converged {
                return Ok(());
            }
            let mut noise = 0.0;
            if is_noisy && level > T::int(1) {
                noise = self.noise_allowed(SHARE);
            }
            if !is_done {
                // Too many updates have not halved the residual. The limit is larger beyond 31 digits.
                if stalls > MOST_STALLS.max(T::MANTISSA_BITS / 26) {
                    break;
                }
                // Up to this many round-off levels, the residual after one update is round-off. Above, an
                // update reduces the residual to this share, and the noise must be as small a share of the
                // reduced residual.
                if level > T::int(SHARE) {
                    noise = self.noise_allowed(SHARE * SHARE);
                }
                self.update_once(solver, y)?;
            }
            let converged = self.converge((y, h), next, noise);
            is_converged = converged.map_err(|_| Outcome::BeyondBound)?;
            self.evaluate_constraints(next, self.stages.contraction.noise())
                .map_err(|_| Outcome::BeyondBound)?;
            if !is_done {
                solver.direction.learn(&self.constraints);
                let level = self.in_late_levels();
                stalls += u32::from(last.is_finite() && T::int(2) * level > last);
                last = level;
                self.check_displacement(solver, (y, h), next, bounds)?;
            }
        }
        Err(Outcome::NoEffect)
    }

    /// Iterates Z with the present α until it has converged, or until its noise at y1 is at most `noise`.
    /// Returns whether it has converged.
    pub(crate) fn converge(
        &mut self,
        (y, h): (&State<T>, T),
        next: &mut State<T>,
        noise: f64,
    ) -> Result<bool, Failure<T>> {
        let stages = &mut self.stages;
        let converged = stages.converge(&mut self.energy, (y, h), noise, &mut self.counts)?;
        stages.iterate.end_point(y, next);
        Ok(converged)
    }

    /// The noise of y1 that changes every constraint by at most 1/`share` of its residual.
    pub(crate) fn noise_allowed(&self, share: i64) -> f64 {
        let sizes = self.stages.iterate.scale();
        let allowed = self.constraints.iter().map(|c| c.noise_equivalent(sizes));
        let least = allowed.fold(T::INFINITY, |least, noise| least.min(noise));
        (least / T::int(share)).to_f64()
    }

    /// The bounds on the change of y1, without the local error.
    fn bounds(&self, solver: &mut AlphaSolver<T>, next: &State<T>, y: &State<T>) -> Bounds<T> {
        solver.direction.begin(&self.stages.iterate, y, next);
        let direction = &solver.direction;
        let least = |units: &[T], of: fn(&Constraint<T>) -> T| {
            let worth = |c: &Constraint<T>| c.least_displacement(of(c), units);
            self.constraints
                .iter()
                .fold(T::int(0), |most, c| most.max(worth(c)))
        };
        let units = direction.motion.each_ref();
        let needed = units.map(|units| least(units, |c| c.residual));
        let own = units.map(|units| least(units, |c| c.residual - c.start_error));
        let is_free = self.options.alpha_policy == AlphaPolicy::Always;
        Bounds::new(needed, own, solver.handed_on, is_free)
    }

    /// Linearises the stage equations. An error states why no admissible α can satisfy the constraints.
    fn linearise(
        &mut self,
        solver: &mut AlphaSolver<T>,
        step: (&State<T>, T),
        next: &State<T>,
        bounds: &mut Bounds<T>,
    ) -> Result<(), Outcome> {
        let (needed, is_free) = (
            bounds.needed,
            self.options.alpha_policy == AlphaPolicy::Always,
        );
        let size = solver.direction.largest_size(next);
        let is_rounding = needed[0] <= T::int(STATE_ROUNDING) * T::EPSILON * size;
        if !is_rounding && !bounds.is_small(needed) {
            return Err(Outcome::TooFar);
        }
        let stages = self.stages.iterate.stages();
        self.counts.add_hessians(stages, &self.energy);
        if !(solver.direction).linearise(&self.stages.iterate, &mut self.energy) {
            return Err(Outcome::NoEffect);
        }
        if !is_free && !solver.direction.is_resolved() {
            return Err(Outcome::Unresolved);
        }
        if is_rounding || self.is_admissible(solver, step, bounds, needed) {
            Ok(())
        } else {
            Err(Outcome::TooFar)
        }
    }

    /// Whether this `change` of y1 is admissible. The local error is estimated if it is needed, once in a
    /// step.
    fn is_admissible(
        &mut self,
        solver: &mut AlphaSolver<T>,
        step: (&State<T>, T),
        bounds: &mut Bounds<T>,
        change: [T; 2],
    ) -> bool {
        if bounds.holds(change) || !bounds.is_small(change) {
            return bounds.holds(change);
        }
        if let Some(local_error) = &mut solver.local_error
            && !std::mem::replace(&mut bounds.has_error, true)
        {
            self.counts.local_errors += 1;
            let at = (&self.stages.iterate, solver.kept.increments());
            let linear = (&mut solver.direction, self.stages.choice.operator());
            let (energy, counts) = (&mut self.energy, &mut self.counts);
            if let Some(error) = local_error.estimate(energy, step, at, linear, counts) {
                bounds.extend(error);
            }
        }
        bounds.holds(change)
    }

    /// Computes D. Its tolerance is the accuracy that is visible in y1, or the required change of y1 if that
    /// is larger: D changes by about as much along this change, so the step is symmetric to second order in
    /// both cases.
    fn compute_direction(
        &mut self,
        solver: &mut AlphaSolver<T>,
        bounds: &Bounds<T>,
    ) -> Result<(), Outcome> {
        let rounding = T::int(STATE_ROUNDING) * T::EPSILON;
        let coarsest = T::ratio(1, SHARE);
        let needed = bounds.needed[0];
        let tolerance = (rounding / needed).max(needed).min(coarsest);
        self.counts.directions += 1;
        let at = (&self.stages.iterate, self.constraints.as_slice());
        let operator = self.stages.choice.operator();
        let is_computed = solver.direction.compute(at, tolerance, operator);
        is_computed.then_some(()).ok_or(Outcome::NoEffect)
    }

    /// Updates t, and Z accordingly.
    fn update_once(&mut self, solver: &mut AlphaSolver<T>, y: &State<T>) -> Result<(), Outcome> {
        if !solver.direction.update(&self.constraints, &mut self.alphas) {
            return Err(Outcome::NoEffect);
        }
        let bound = self.options.alpha_bound;
        if !self.alphas.iter().all(|alpha| alpha.abs() <= bound) {
            return Err(Outcome::BeyondBound);
        }
        self.counts.alpha_updates += 1;
        let stages = &mut self.stages;
        stages.iterate.set_alphas(&stages.method, &self.alphas);
        solver.direction.follow(&mut stages.iterate, y);
        stages.contraction.disturb();
        Ok(())
    }

    /// The largest constraint in multiples of its round-off level.
    fn in_late_levels(&self) -> T {
        let residuals = self.constraints.iter().map(Constraint::in_late_levels);
        residuals.fold(T::int(0), |most, level| most.max(level))
    }

    /// Evaluates the constraints at y1. The iteration for the stages has left `noise` in y1.
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

    /// Whether the change of y1 from its value with α = 0 is admissible, apart from rounding.
    fn check_displacement(
        &mut self,
        solver: &mut AlphaSolver<T>,
        step: (&State<T>, T),
        next: &State<T>,
        bounds: &mut Bounds<T>,
    ) -> Result<(), Outcome> {
        let rounding = T::int(FARTHEST * STATE_ROUNDING) * T::EPSILON;
        let ends = next.hi.iter().zip(&solver.unperturbed.hi);
        let moved = ends.map(|(&end, &before)| {
            let moved = (end - before).abs();
            if moved > rounding * end.abs() {
                moved
            } else {
                T::int(0)
            }
        });
        let change = solver.direction.in_units(moved);
        if self.is_admissible(solver, step, bounds, change) {
            Ok(())
        } else {
            Err(Outcome::TooFar)
        }
    }
}
