//! One step, as the paper reads: initial guess → stages → α → accept → update.
//!
//! The equations are those of [`crate::equations::oracle`]: Z = K(α) L(Z), α = λ d(Z), H(y0 + Σ L_i) = H_ref.
//! How their solution is found is no part of what it is.

use crate::alpha::direction::Direction;
use crate::alpha::local_error::LocalError;
use crate::equations::constraint::Constraint;
use crate::options::step_options::StepOptions;
use crate::outcome::failure::Failure;
use crate::outcome::outcome::{Counts, Outcome};
use crate::outcome::parts::Parts;
use crate::step::stages::Stages;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_sweeps::{Kept, State};
use equip_tableau::Gauss;

/// Everything a step works with; no allocation after it is made.
#[derive(Debug)]
pub struct Core<T: Float, E> {
    pub(crate) energy: E,
    pub(crate) options: StepOptions<T>,
    pub(crate) counts: Counts,
    /// What the α's are solved for: the energy first, then further invariants; empty if there is nothing.
    pub(crate) constraints: Vec<Constraint<T>>,
    /// The stages Z, and what finds them.
    pub(crate) stages: Stages<T>,
    /// α's, and those that a step starts from: zero, or the fixed ones.
    pub(crate) alphas: Vec<T>,
    pub(crate) start_alphas: Vec<T>,
    /// Which way the α's move, if any are free.
    pub(crate) direction: Option<Direction<T>>,
    pub(crate) local_error: Option<LocalError<T>>,
    /// The stages and the end point with the α's that a step starts from.
    pub(crate) kept: Kept<T>,
    pub(crate) unperturbed: State<T>,
    /// Where ∇I at the start of a step was evaluated.
    pub(crate) start: Vec<T>,
    /// Whether the α's of a step wait until it is [completed](Self::complete).
    pub(crate) is_deferred: bool,
    /// Outcome of a step without constraints.
    unconstrained: Outcome,
    /// Mid points of halved steps, one for each level.
    middles: Vec<State<T>>,
    /// What dense output needs of the parts of a step.
    pub(crate) parts: Parts<T>,
    /// State, time and size of the part that failed last.
    pub(crate) failed: (Vec<T>, T, T),
}

impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// `constraints` holds what the α's are to be solved for.
    pub fn new<H: System<Evaluator<T> = E>>(
        system: &H,
        mut energy: E,
        options: StepOptions<T>,
        gauss: Gauss<T>,
        constraints: Vec<Constraint<T>>,
    ) -> Self {
        let n = 2 * system.degrees_of_freedom();
        let structure = system.structure();
        let mut start_alphas = vec![T::int(0); gauss.stages() - 1];
        if let (Some(alpha), Some(last)) = (options.fixed_alpha, start_alphas.last_mut()) {
            *last = alpha;
        }
        let kinetic = energy.kinetic();
        let preconditioner = options.preconditioner;
        let free = options.first_alpha.filter(|_| !constraints.is_empty());
        let local_error =
            free.and_then(|_| LocalError::new(&gauss, structure, kinetic.clone(), preconditioner));
        let stages = Stages::new(gauss, structure, kinetic, &start_alphas, preconditioner);
        let direction = free.map(|first| {
            let of = (first, constraints.len());
            Direction::new(&stages.gauss, &stages.iterate, &structure.hessian, of)
        });
        let zero = State::new(&vec![T::int(0); n], &[]);
        Core {
            kept: Kept::new(&stages.iterate),
            parts: Parts::new(),
            is_deferred: false,
            unconstrained: if options.first_alpha.is_some() {
                Outcome::Quadratic
            } else {
                Outcome::NotAsked
            },
            middles: vec![zero.clone(); options.max_halvings as usize],
            unperturbed: zero,
            start: vec![T::NAN; n],
            failed: (vec![T::int(0); n], T::int(0), T::int(0)),
            alphas: start_alphas.clone(),
            start_alphas,
            counts: Counts::default(),
            energy,
            options,
            constraints,
            stages,
            local_error,
            direction,
        }
    }

    /// Forgets the last step, so that the next depends on the state alone.
    pub fn forget(&mut self) {
        self.stages.forget();
        self.start.fill(T::NAN);
        self.constraints.iter_mut().for_each(|c| c.late = T::int(0));
    }

    /// One step of size `h` from `y` at time `t` into `next`, which [`step`](Self::step) has made. `y` is not
    /// changed, whatever happens.
    pub(crate) fn make(
        &mut self,
        (y, t, h): (&State<T>, T, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        self.parts.clear();
        self.stages.choice.begin_step();
        let made = self.step_at_level(0, (y, t, h), next);
        match made {
            Ok(_) => self.stages.choice.end_step(self.stages.contraction.rate()),
            Err(_) => self.forget(),
        }
        made
    }

    /// The α's of the step just made, if they were [deferred](Self::defer_alphas).
    pub(crate) fn make_complete(
        &mut self,
        (y, t, h): (&State<T>, T, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        if self.constraints.is_empty() {
            return Ok(self.unconstrained);
        }
        let kept = self.keep((y, h), next);
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
                self.forget();
            }
        }
        kept
    }

    fn fail(&mut self, (y, t, h): (&State<T>, T, T)) {
        self.failed.0.copy_from_slice(&y.hi);
        (self.failed.1, self.failed.2) = (t, h);
    }

    fn step_at_level(
        &mut self,
        level: usize,
        (y, t, h): (&State<T>, T, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
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

    /// Initial guess, stages, α.
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
        let known = self
            .constraints
            .first()
            .map(|c| c.start_gradient.as_slice());
        self.stages
            .solve(&mut self.energy, (y, h), known, &mut self.counts)?;
        self.stages.iterate.end_point(y, next);
        if self.constraints.is_empty() || self.is_deferred {
            return Ok(self.unconstrained);
        }
        self.keep((y, h), next)
    }

    /// Constraints at the end point `next` of the stages with α = 0, and the α's if they need any.
    fn keep(&mut self, (y, h): (&State<T>, T), next: &mut State<T>) -> Result<Outcome, Failure<T>> {
        self.evaluate_constraints(next, self.stages.contraction.noise())?;
        if self.constraints.iter().all(Constraint::is_at_floor) {
            return Ok(Outcome::AtFloor);
        }
        self.keep_constraints((y, h), next)
    }

    /// The end point `next` is accepted, and the constraints have been evaluated there, unless that waits.
    fn accept(&mut self, next: &State<T>, h: T) {
        self.stages.last = Some((T::int(1), h));
        if !self.constraints.is_empty() && !self.is_deferred {
            self.constraints.iter_mut().for_each(Constraint::accept);
            self.start.copy_from_slice(&next.hi);
        }
    }

    /// Two steps of half the size.
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
}
