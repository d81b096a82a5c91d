//! One step, as in the paper: initial guess → stages → α → accept → update.
//!
//! The equations are those of `tests/oracle.rs`: Z = K(α) L(Z), α = D t, H(y0 + Σ L_i) = H_ref.
//! The path to their solution does not affect the solution.

use crate::constraint::Constraint;
use crate::outcome::failure::Failure;
use crate::outcome::outcome::Outcome;
use crate::policy::SHARE;
use crate::step::core::Core;
use equip_iterate::State;
use equip_scalar::Float;

impl<T: Float> Core<T> {
    /// One step of size `h` from `y` at time `t` to `next`, called by [`step`](Self::step). `y` does not
    /// change, even on failure.
    pub(crate) fn make(
        &mut self,
        (y, t, h): (&State<T>, T, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        self.parts.clear();
        self.stages.choice.begin_step();
        self.constraints.iter_mut().for_each(Constraint::begin_step);
        if let Some(solver) = &mut self.alpha_solver {
            solver.handed_on_before = solver.handed_on;
        }
        let made = self.step_at_level(0, (y, t, h), next);
        match made {
            Ok(_) => self.stages.choice.end_step(),
            Err(_) => {
                self.constraints.iter_mut().for_each(Constraint::restore);
                self.forget_step();
            }
        }
        made
    }

    /// Computes the α_k of the last step, if they were [deferred](Self::defer_alphas).
    pub(crate) fn make_complete(
        &mut self,
        (y, t, h): (&State<T>, T, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        if self.constraints.is_empty() {
            return Ok(self.unconstrained);
        }
        self.may_be_halved = false;
        let kept = self.keep((y, h), next, true);
        match kept {
            Ok(_) => {
                self.constraints.iter_mut().for_each(Constraint::accept);
                self.start.copy_from_slice(&next.hi);
                self.parts.clear();
                self.parts
                    .add((y, t, h), &self.stages.iterate, &self.alphas);
            }
            Err(_) => {
                self.fail((y, t, h));
                self.forget_step();
            }
        }
        kept
    }

    fn fail(&mut self, (y, t, h): (&State<T>, T, T)) {
        self.failed.start.copy_from_slice(&y.hi);
        (self.failed.time, self.failed.step) = (t, h);
    }

    fn step_at_level(
        &mut self,
        level: usize,
        (y, t, h): (&State<T>, T, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        self.may_be_halved = level < self.middles.len();
        match self.attempt((y, h), next) {
            Ok(outcome) => {
                self.accept(next, h);
                self.parts
                    .add((y, t, h), &self.stages.iterate, &self.alphas);
                Ok(outcome)
            }
            Err(failure) if level == self.middles.len() || failure == Failure::NoAlpha => {
                self.fail((y, t, h));
                Err(failure)
            }
            Err(_) => self.halve(level, (y, t, h), next),
        }
    }

    /// One attempt: initial guess, stages, α.
    fn attempt(
        &mut self,
        (y, h): (&State<T>, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        if !self.constraints.is_empty() && self.start != y.hi {
            for constraint in &mut self.constraints {
                constraint.evaluate_start(&mut self.energy, y);
                self.counts.gradients += 1;
            }
            self.start.copy_from_slice(&y.hi);
        }
        self.alphas.copy_from_slice(&self.start_alphas);
        let energy = self.constraints.first().filter(|c| c.is_energy());
        // ∇H is the vector w of y' = Jw in a canonical system only.
        let energy = energy.filter(|_| self.energy.is_canonical());
        let known = energy.map(|c| c.start_gradient.as_slice());
        let is_last = self.constraints.is_empty() || self.is_deferred;
        let noise = if is_last { 0.0 } else { self.noise_expected };
        let is_converged =
            (self.stages).solve(&mut self.energy, (y, h), known, noise, &mut self.counts)?;
        self.stages.iterate.end_point(y, next);
        if is_last {
            self.check_energy((y, h), next)?;
            return Ok(self.unconstrained);
        }
        self.keep((y, h), next, is_converged)
    }

    /// Evaluates the constraints at the end point `next` of the stages with α = 0, and solves for α if
    /// necessary.
    fn keep(
        &mut self,
        (y, h): (&State<T>, T),
        next: &mut State<T>,
        mut is_converged: bool,
    ) -> Result<Outcome, Failure<T>> {
        let noise = self.stages.contraction.noise();
        self.evaluate_constraints(next, noise)?;
        let is_at_round_off =
            |core: &Self| core.constraints.iter().all(Constraint::is_at_round_off);
        if !is_converged && (is_at_round_off(self) || noise > 10.0 * self.noise_allowed(SHARE)) {
            is_converged = self.converge((y, h), next, 0.0)?;
            self.evaluate_constraints(next, self.stages.contraction.noise())?;
        }
        if is_at_round_off(self) {
            self.noise_expected = 0.0;
            return Ok(Outcome::AtRoundOff);
        }
        self.check_residual(h)?;
        self.noise_expected = self.noise_allowed(SHARE);
        self.solve_alphas((y, h), next, is_converged)
    }

    /// Accepts the end point `next`, where the constraints have been evaluated unless they are deferred.
    fn accept(&mut self, next: &State<T>, h: T) {
        self.stages.last = Some((T::int(1), h));
        if !self.constraints.is_empty() && !self.is_deferred {
            self.constraints.iter_mut().for_each(Constraint::accept);
            self.start.copy_from_slice(&next.hi);
        }
    }

    /// Splits a step into two of half the size.
    fn halve(
        &mut self,
        level: usize,
        (y, t, h): (&State<T>, T, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        self.counts.halvings += 1;
        let h = h / T::int(2);
        let mut middle = std::mem::replace(&mut self.middles[level], State::empty());
        let halves = self
            .step_at_level(level + 1, (y, t, h), &mut middle)
            .and_then(|first| {
                let second = self.step_at_level(level + 1, (&middle, t + h, h), next)?;
                Ok(first.max(second))
            });
        self.middles[level] = middle;
        halves
    }
}
