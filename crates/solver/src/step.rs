//! One step, as the paper reads: initial guess → stages and α → accept, or halve and try again → update.

use crate::MAX_STAGES;
use crate::alpha::Norm;
use crate::constraint::{Constraint, worst};
use crate::failure::Failure;
use crate::guess::Guess;
use crate::newton::{ENERGY_STAGNATED, Newton, StepTask, nearly_met};
use crate::one_more::OneMore;
use crate::options::{OnNoAlpha, StageSolver, StepOptions};
use crate::outcome::{Counts, Outcome};
use crate::parts::Parts;
use crate::ready::ready;
use crate::response::LEADING;
use crate::stages::Stages;
use crate::state::State;
use crate::step_swept::{KnownGradient, Pause, Then, can_sweep, rule};
use crate::sweep_task::{Rule, Trouble};
use crate::sweeps::Sweeps;
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_tableau::Gauss;

/// Most unknowns s·2m for which a run by sweeps alone calls on Newton's method to repair what a close encounter has left.
const MOST_UNKNOWNS: usize = 128;

/// In wide numbers directions are repeated to a fixed point up to this size s·n: each time takes a dense factorisation of it.
const REPEATED_UP_TO: usize = 128;

/// Everything a step works with; no allocation after it is made.
#[derive(Debug)]
pub struct Core<T: Float, E> {
    pub(crate) energy: E,
    pub(crate) stages: Stages<T>,
    pub(crate) newton: Newton<T>,
    /// What the α's are solved for: the energy first, then further invariants; empty if there is nothing.
    pub(crate) constraints: Vec<Constraint<T>>,
    pub(crate) counts: Counts,
    pub(crate) options: StepOptions<T>,
    pub(crate) sweeps: Option<Sweeps<T>>,
    pub(crate) rule: Rule,
    /// Newton's turn.
    pub(crate) pause: Pause,
    /// Steps that are halved at once, for each level.
    pub(crate) halved: Vec<Pause>,
    pub(crate) guess: Guess<T>,
    /// α's a step starts from: zero, or the fixed ones.
    pub(crate) start_alphas: Vec<T>,
    /// Outcome of a step without constraints.
    unconstrained: Outcome,
    /// Mid points of halved steps, one per level.
    middles: Vec<State<T>>,
    /// ∇H where the next step starts.
    pub(crate) start: KnownGradient<T>,
    /// Whether a step for which no admissible α was found is tried with fewer of them before it is carried.
    pub(crate) last_resort: bool,
    /// The parts of the step, if dense output is wanted.
    pub(crate) parts: Parts<T>,
    /// Where the step that failed last began, with its time and size.
    pub(crate) failed: (Vec<T>, T, T),
    /// Room for ∇²H where stiff springs are looked for.
    pub(crate) hessian_room: Vec<T>,
    /// hω of the stiffest spring that sweeps do not solve for, as α's are not found with it.
    pub(crate) unresolved_spring: Option<T>,
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
        let (s, n) = (gauss.stages(), 2 * system.degrees_of_freedom());
        let structure = system.structure();
        let mut start_alphas = vec![T::int(0); s - 1];
        if let (Some(alpha), Some(last)) = (options.fixed_alpha, start_alphas.last_mut()) {
            *last = alpha;
        }
        let asked = options.first_alpha.is_some();
        let zero = State::new(&vec![T::int(0); n], &[]);
        let rule = rule(&options, (s, n), constraints.len());
        let is_alone = options.stage_solver == StageSolver::Sweeps;
        let free = options.first_alpha.map_or(0, |first| s - first);
        let wants_errors = !constraints.is_empty() && free > 1;
        let finer = wants_errors.then(|| OneMore::new(&gauss)).flatten();
        let alphas = (rule, &structure.hessian, is_alone);
        let sweeps = can_sweep(&options, s, constraints.len()).then(|| {
            let methods = (&gauss, finer.as_ref());
            (ready::<T>().sweeps)(methods, n, energy.kinetic(), &start_alphas, alphas)
        });
        Core {
            sweeps,
            rule,
            pause: Pause::NONE,
            halved: vec![Pause::NONE; options.max_halvings as usize],
            energy,
            newton: (ready::<T>().newton)(
                s,
                finer.as_ref(),
                structure,
                options.stage_solver,
                (constraints.len(), free),
                options.max_iterations,
            ),
            constraints,
            counts: Counts::default(),
            guess: Guess::new(s, n),
            start_alphas,
            unconstrained: if asked {
                Outcome::Quadratic
            } else {
                Outcome::NotAsked
            },
            middles: vec![zero; options.max_halvings as usize],
            start: KnownGradient {
                y: vec![T::NAN; n],
                gradient: vec![T::int(0); n],
            },
            last_resort: true,
            parts: Parts::new(),
            failed: (vec![T::int(0); n], T::int(0), T::int(0)),
            hessian_room: Vec::new(),
            unresolved_spring: None,
            stages: Stages::new(gauss, n),
            options,
        }
    }

    /// Forgets the last step, so that the next depends on the state alone.
    pub fn forget(&mut self) {
        self.guess.forget();
        self.newton.forget();
        self.pause = Pause::NONE;
        self.halved.fill(Pause::NONE);
        if let Some(sweeps) = &mut self.sweeps {
            sweeps.forget();
        }
    }

    /// One step of size `h` from `y` at time `t` into `next`, as [`step`](Self::step) has it made. `y` is not changed, whatever happens.
    pub(crate) fn make(
        &mut self,
        (y, t, h): (&State<T>, T, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        self.parts.clear();
        self.step_at_level(0, y, t, h, next)
    }

    fn step_at_level(
        &mut self,
        level: u32,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        let failure = match self.attempt(level, (y, h), next) {
            Ok(outcome) => {
                self.accept(next);
                self.add_part(y, t, h);
                return Ok(outcome);
            }
            Err(failure) => failure,
        };
        // A defect of a few floors that no α removes is round-off, …
        let round_off = failure == Failure::NoAlpha && nearly_met(&self.constraints);
        // … but one that only an earlier step may call so is worth another try here.
        let last_try = round_off || (self.last_resort && level == self.options.max_halvings);
        let wanted = failure == Failure::NoAlpha && last_try && self.has_inherited();
        if wanted && self.with_fewer_alphas(y, h, next) {
            self.accept(next);
            self.add_part(y, t, h);
            return Ok(Outcome::Solved);
        }
        let left = self.options.max_halvings - level;
        let halves = left > 0;
        // Halving is of no use that does not resolve the motion either.
        let as_it_is =
            round_off || (failure == Failure::Unresolved && self.newton.stays_unresolved(left));
        if as_it_is {
            let made = self.without_alpha(y, t, h, next);
            if !(halves && matches!(made, Err(Failure::Astray { .. }))) {
                return made;
            }
        }
        if halves {
            return self.halve(level, y, t, h, next);
        }
        match failure {
            Failure::NoAlpha | Failure::Unresolved => self.without_alpha(y, t, h, next),
            other => Err(self.fails(other, y, t, h)),
        }
    }

    /// Notes where a part of the step failed.
    fn fails(&mut self, failure: Failure<T>, y: &State<T>, t: T, h: T) -> Failure<T> {
        let (start, time, step) = &mut self.failed;
        start.copy_from_slice(&y.hi);
        (*time, *step) = (t, h);
        failure
    }

    /// The constraints have been evaluated at the end point `next`, which is accepted.
    fn accept(&mut self, next: &State<T>) {
        self.constraints.iter_mut().for_each(Constraint::accept);
        if let Some(energy) = self.constraints.first() {
            self.start.y.copy_from_slice(&next.hi);
            self.start.gradient.copy_from_slice(&energy.gradient);
        }
    }

    fn halve(
        &mut self,
        level: u32,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        self.counts.halvings += 1;
        let h = h / T::int(2);
        let mut middle = std::mem::replace(&mut self.middles[level as usize], State::empty());
        let end = self
            .step_at_level(level + 1, y, t, h, &mut middle)
            .and_then(|_| self.step_at_level(level + 1, &middle, t + h, h, next));
        self.middles[level as usize] = middle;
        Ok(match end? {
            // Halving adds nothing to what is known of an energy that is not solved for.
            outcome @ (Outcome::Carried | Outcome::Quadratic | Outcome::NotAsked) => outcome,
            _ => Outcome::Halved,
        })
    }

    /// No admissible α at this size and no halving left: the step with α = 0, or an error, as the user chose.
    fn without_alpha(
        &mut self,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        let then = self.then(self.options.max_halvings);
        let swept = self.sweep(then, (y, h), false, next).is_ok();
        if !swept {
            self.solve(y, h, false, (Norm::Plain, 0), next)
                .map_err(|failure| self.fails(failure, y, t, h))?;
        }
        let sizes = match &self.sweeps {
            Some(sweeps) if swept => &sweeps.iterate.scale,
            _ => &self.stages.scale,
        };
        for constraint in &mut self.constraints {
            self.counts.gradients += 1;
            constraint.evaluate(&mut self.energy, next, sizes);
        }
        let at_floor = worst(&self.constraints, Constraint::in_judging_floors);
        // With all of the 8 floors that are promised: nothing more is evaluated.
        if at_floor <= T::int(ENERGY_STAGNATED + 1) {
            self.accept(next);
            self.add_part(y, t, h);
            return Ok(Outcome::AtFloor);
        }
        if let Some(energy) = self.constraints.first_mut() {
            self.counts.gradients += 1;
            energy.evaluate_start(&mut self.energy, y);
            let (defect, scale) = (energy.defect, energy.start_scale(y));
            if !(defect.abs() <= scale) {
                let failure = Failure::Astray { defect, scale };
                return Err(self.fails(failure, y, t, h));
            }
        }
        self.accept(next);
        self.add_part(y, t, h);
        match self.options.on_no_alpha {
            OnNoAlpha::Carry => Ok(Outcome::Carried),
            OnNoAlpha::Refuse => Err(self.fails(Failure::NoAlpha, y, t, h)),
        }
    }

    /// The last α's move the energy least for what they move the end point, and so are the first to be asked for; in a step that is well resolved they move it
    /// so little that they meet their bound over a defect which an earlier step has left. The others need not: the step without the last α, without the last
    /// two, … Returns whether one was found.
    fn with_fewer_alphas(&mut self, y: &State<T>, h: T, next: &mut State<T>) -> bool {
        let most = self.free_alphas().saturating_sub(self.constraints.len());
        self.can_repair()
            && (1..=most).any(|left_out| {
                let solved = self.solve(y, h, true, (Norm::Resolved, left_out), next);
                solved.is_ok()
            })
    }

    /// Whether a defect that earlier steps have left can be repaired by fewer α's: that takes Newton's method, also where sweeps alone are asked for, as long as
    /// it is cheap.
    pub(crate) fn can_repair(&self) -> bool {
        let unknowns = self.stages.count() * self.stages.n;
        self.options.stage_solver != StageSolver::Sweeps || unknowns <= MOST_UNKNOWNS
    }

    /// Whether a defect with α = 0 is far beyond the step's own floor, and so round-off of an earlier step only. What is a few of its own floors may be H's
    /// own rounding, and is not worth the large α's that remove it.
    fn has_inherited(&self) -> bool {
        let most = T::int(8 * ENERGY_STAGNATED);
        let beyond = |c: &Constraint<T>| c.without_alpha.abs() > most * c.floor;
        self.constraints.iter().any(beyond)
    }

    /// One try at the full size: by sweeps if they contract, else, if its halves do not come first, by Newton, the α's by the norm that spares the
    /// slow motion, else by the plain one.
    fn attempt(
        &mut self,
        level: u32,
        (y, h): (&State<T>, T),
        next: &mut State<T>,
    ) -> Result<Outcome, Failure<T>> {
        let constrained = !self.constraints.is_empty();
        let then = self.then(level);
        if let Err(trouble) = self.sweep(then, (y, h), constrained, next) {
            if let (Then::Halves(_) | Then::Nothing, Some(sweeps)) = (then, &self.sweeps) {
                return Err(sweeps.failure(trouble));
            }
            // A defect of a few floors that α's do not reach, or whatever no α reaches: Newton would not either.
            let out_of_reach = self
                .sweeps
                .as_ref()
                .is_some_and(Sweeps::are_alphas_out_of_reach);
            if trouble == Trouble::NoAlpha && (out_of_reach || nearly_met(&self.constraints)) {
                return Err(Failure::NoAlpha);
            }
            let mut solved = self.solve(y, h, constrained, (Norm::Slow, 0), next);
            for norm in [Norm::Resolved, Norm::Plain] {
                let again = self.free_alphas() > 1 && !nearly_met(&self.constraints);
                let same = norm == Norm::Resolved && !self.newton.met_unresolved_motion();
                if solved == Err(Failure::NoAlpha) && again && !same {
                    solved = self.solve(y, h, constrained, (norm, 0), next);
                }
            }
            solved?;
        }
        Ok(if !constrained {
            self.unconstrained
        } else if self.stages.alphas_are_zero {
            Outcome::AtFloor
        } else {
            Outcome::Solved
        })
    }

    /// A part of the step for those who want its stages.
    fn add_part(&mut self, y: &State<T>, t: T, h: T) {
        if self.parts.wanted {
            self.fetch_l();
            self.parts.add(y, t, h, &self.stages);
        }
    }

    fn free_alphas(&self) -> usize {
        let most = if self.is_to_return() {
            LEADING
        } else {
            MAX_STAGES
        };
        self.options
            .first_alpha
            .map_or(0, |first| (self.stages.count() - first).min(most))
    }

    /// Initial guess and solution of system (7); from the state alone if the prolonged guess leads nowhere.
    fn solve(
        &mut self,
        y: &State<T>,
        h: T,
        constrained: bool,
        (norm, left_out): (Norm, usize),
        next: &mut State<T>,
    ) -> Result<(), Failure<T>> {
        let task = StepTask {
            y,
            h,
            constrained,
            first: self.options.first_alpha.unwrap_or(1),
            end: self.options.first_alpha.unwrap_or(1) + self.free_alphas() - left_out,
            norm,
            alpha_bound: self.options.alpha_bound,
            max_iterations: self.options.max_iterations,
            pure: self.options.pure_newton,
            repeat: T::EPSILON < T::ratio(1, 1 << 60)
                && !self.options.pure_newton
                && self.stages.z.len() <= REPEATED_UP_TO,
        };
        loop {
            self.stages.set_alphas(&self.start_alphas);
            self.guess.make(&mut self.stages, h);
            let solved = self.newton.solve(
                &mut self.stages,
                &mut self.constraints,
                next,
                &mut self.energy,
                &task,
                &mut self.counts,
            );
            match solved {
                Ok(()) => {
                    self.guess.remember(&self.stages.l, h);
                    if self.newton.met_unresolved_motion() {
                        self.guess.forget();
                    }
                    return solved;
                }
                Err(Failure::NoAlpha | Failure::Unresolved) => return solved,
                Err(_) if self.newton.take_over() => {}
                Err(_) if !self.guess.is_from_last_step() => return solved,
                Err(_) => self.guess.forget(),
            }
        }
    }
}
