//! One step, as the paper reads: initial guess → stages and α → accept, or halve and try again → update.

use crate::alpha::Norm;
use crate::constraint::{Constraint, worst};
use crate::dense::Parts;
use crate::error::IntegrateError;
use crate::escape::escapes;
use crate::guess::Guess;
use crate::newton::{ENERGY_STAGNATED, Failure, Newton, StepTask, nearly_met};
use crate::options::{OnNoAlpha, Settings, StageSolver};
use crate::outcome::{Counts, Outcome};
use crate::stages::Stages;
use crate::state::State;
use crate::sweeps::{SweepTask, Sweeps, Trouble};
use equip_autodiff::{Evaluate, System};
use equip_scalar::Float;
use equip_tableau::Gauss;

/// Everything a step works with; no allocation after it is made.
#[derive(Debug)]
pub(crate) struct Core<T: Float, E> {
    pub(crate) energy: E,
    pub(crate) stages: Stages<T>,
    pub(crate) newton: Newton<T>,
    /// What the α's are solved for: the energy first, then further invariants; empty if there is nothing.
    pub(crate) constraints: Vec<Constraint<T>>,
    pub(crate) counts: Counts,
    pub(crate) settings: Settings<T>,
    pub(crate) sweeps: Option<Sweeps<T>>,
    pub(crate) pause: Pause,
    pub(crate) guess: Guess<T>,
    /// α's a step starts from: zero, or the fixed ones.
    start_alphas: Vec<T>,
    /// Outcome of a step without constraints.
    unconstrained: Outcome,
    /// Mid points of halved steps, one per level.
    middles: Vec<State<T>>,
    /// The parts of the step, if dense output is wanted.
    pub(crate) parts: Parts<T>,
}

/// Steps that Newton makes before sweeps are tried again: 1, 2, 4, … 64 while they fail.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pause {
    pub(crate) left: u32,
    pub(crate) next: u32,
}

impl Pause {
    const NONE: Self = Pause { left: 0, next: 1 };

    fn lengthen(&mut self) {
        self.left = self.next;
        self.next = (2 * self.next).min(64);
    }
}

impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// `constraints` holds what the α's are to be solved for.
    pub(crate) fn new<H: System<Evaluator<T> = E>>(
        system: &H,
        mut energy: E,
        settings: Settings<T>,
        gauss: Gauss<T>,
        constraints: Vec<Constraint<T>>,
    ) -> Self {
        let (s, n) = (gauss.stages(), 2 * system.degrees_of_freedom());
        let structure = system.structure();
        let mut start_alphas = vec![T::int(0); s - 1];
        if let (Some(alpha), Some(last)) = (settings.fixed_alpha, start_alphas.last_mut()) {
            *last = alpha;
        }
        let asked = settings.first_alpha.is_some();
        let zero = State::new(&vec![T::int(0); n], &[]);
        let sweeps = can_sweep(&settings, s, constraints.len())
            .then(|| Sweeps::new(&gauss, n, energy.kinetic(), &start_alphas));
        Core {
            sweeps,
            pause: Pause::NONE,
            energy,
            newton: Newton::new(
                &gauss,
                structure,
                settings.stage_solver,
                (
                    constraints.len(),
                    settings.first_alpha.map_or(0, |first| s - first),
                ),
                settings.max_iterations,
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
            middles: vec![zero; settings.max_halvings as usize],
            parts: Parts::new(),
            stages: Stages::new(gauss, n),
            settings,
        }
    }

    /// Forgets the last step, so that the next depends on the state alone.
    pub(crate) fn forget(&mut self) {
        self.guess.forget();
        self.newton.forget();
        self.pause = Pause::NONE;
        if let Some(sweeps) = &mut self.sweeps {
            sweeps.forget();
        }
    }

    /// One step of size `h` from `y` at time `t` into `next`. `y` is not changed, whatever happens.
    pub(crate) fn step(
        &mut self,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, IntegrateError<T>> {
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
    ) -> Result<Outcome, IntegrateError<T>> {
        let failure = match self.attempt(y, h, next) {
            Ok(outcome) => {
                self.constraints.iter_mut().for_each(Constraint::accept);
                self.parts.add(y, t, h, &self.stages);
                return Ok(outcome);
            }
            Err(failure) => failure,
        };
        let left = self.settings.max_halvings - level;
        let halves = left > 0;
        // A defect of a few floors that no α removes is round-off, and halving is of no use that does not resolve the motion either.
        let as_it_is = match failure {
            Failure::NoAlpha => nearly_met(&self.constraints),
            Failure::Unresolved => self.newton.stays_unresolved(left),
            _ => false,
        };
        if as_it_is {
            let made = self.without_alpha(y, t, h, next);
            if !(halves && matches!(made, Err(IntegrateError::Astray { .. }))) {
                return made;
            }
        }
        if halves {
            return self.halve(level, y, t, h, next);
        }
        match failure {
            Failure::NoAlpha | Failure::Unresolved => self.without_alpha(y, t, h, next),
            other => Err(self.error(other, y, t, h)),
        }
    }

    fn halve(
        &mut self,
        level: u32,
        y: &State<T>,
        t: T,
        h: T,
        next: &mut State<T>,
    ) -> Result<Outcome, IntegrateError<T>> {
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
    ) -> Result<Outcome, IntegrateError<T>> {
        let swept = self.sweep(y, h, false, next).is_ok();
        if !swept {
            self.solve(y, h, false, Norm::Plain, next)
                .map_err(|failure| self.error(failure, y, t, h))?;
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
        if at_floor <= T::int(ENERGY_STAGNATED) {
            self.constraints.iter_mut().for_each(Constraint::accept);
            self.parts.add(y, t, h, &self.stages);
            return Ok(Outcome::AtFloor);
        }
        if let Some(energy) = self.constraints.first_mut() {
            self.counts.gradients += 1;
            energy.evaluate_start(&mut self.energy, y);
            let (defect, scale) = (energy.defect, energy.start_scale(y));
            if !(defect.abs() <= scale) {
                let failure = Failure::Astray { defect, scale };
                return Err(self.error(failure, y, t, h));
            }
        }
        self.constraints.iter_mut().for_each(Constraint::accept);
        self.parts.add(y, t, h, &self.stages);
        match self.settings.on_no_alpha {
            OnNoAlpha::Carry => Ok(Outcome::Carried),
            OnNoAlpha::Refuse => Err(self.error(Failure::NoAlpha, y, t, h)),
        }
    }

    /// One try at the full size: by sweeps if they contract, else by Newton, the α's by the norm that spares the slow motion,
    /// else by the plain one.
    fn attempt(&mut self, y: &State<T>, h: T, next: &mut State<T>) -> Result<Outcome, Failure<T>> {
        let constrained = !self.constraints.is_empty();
        if let Err(trouble) = self.sweep(y, h, constrained, next) {
            if let (StageSolver::Sweeps, Some(sweeps)) = (self.settings.stage_solver, &self.sweeps)
            {
                return Err(sweeps.failure(trouble));
            }
            let mut solved = self.solve(y, h, constrained, Norm::Slow, next);
            for norm in [Norm::Resolved, Norm::Plain] {
                let again = self.free_alphas() > 1 && !nearly_met(&self.constraints);
                let same = norm == Norm::Resolved && !self.newton.met_unresolved_motion();
                if solved == Err(Failure::NoAlpha) && again && !same {
                    solved = self.solve(y, h, constrained, norm, next);
                }
            }
            solved?;
        }
        let zero = |alpha: &T| *alpha == T::int(0);
        Ok(if !constrained {
            self.unconstrained
        } else if self.stages.alphas.iter().all(zero) {
            Outcome::AtFloor
        } else {
            Outcome::Solved
        })
    }

    /// System (7) by sweeps, unless it is Newton's turn.
    fn sweep(
        &mut self,
        y: &State<T>,
        h: T,
        constrained: bool,
        next: &mut State<T>,
    ) -> Result<(), Trouble> {
        let Some(sweeps) = &mut self.sweeps else {
            return Err(Trouble::Slow);
        };
        if self.pause.left > 0 {
            self.pause.left -= 1;
            return Err(Trouble::Slow);
        }
        let task = SweepTask {
            y,
            h,
            alphas: &self.start_alphas,
            alpha_bound: self.settings.alpha_bound,
            moves_alphas: self.settings.stage_solver == StageSolver::Sweeps,
        };
        let constraint = self.constraints.first_mut().filter(|_| constrained);
        let prolong = self.guess.prolongation(h);
        if !self.guess.is_swept() {
            sweeps.iterate.take_l(self.guess.last().0);
        }
        let swept = sweeps.solve(
            &self.stages.gauss,
            &mut self.energy,
            constraint,
            prolong,
            (next, &task),
            &mut self.counts,
        );
        match swept {
            Ok(()) => {
                self.pause = Pause::NONE;
                sweeps.iterate.give_l(&mut self.stages.l);
                sweeps.iterate.give_z(y, &mut self.stages.z);
                self.stages.note_alphas(&sweeps.alphas);
                self.guess.remember_swept(&self.stages.l, h);
            }
            Err(trouble) => {
                self.counts.taken_over += 1;
                if trouble == Trouble::StagesOnly {
                    // They contracted.
                    self.pause = Pause::NONE;
                    sweeps.iterate.give_z(y, &mut self.stages.z);
                    self.guess.is_made();
                } else if self.settings.stage_solver == StageSolver::Sweeps {
                    // There is no other solver: what is tried next, in parts, starts from the state alone.
                    self.guess.forget();
                }
                if trouble == Trouble::Slow {
                    self.pause.lengthen();
                }
            }
        }
        swept
    }

    fn free_alphas(&self) -> usize {
        self.settings
            .first_alpha
            .map_or(0, |first| self.stages.count() - first)
    }

    /// Initial guess and solution of system (7); from the state alone if the prolonged guess leads nowhere.
    fn solve(
        &mut self,
        y: &State<T>,
        h: T,
        constrained: bool,
        norm: Norm,
        next: &mut State<T>,
    ) -> Result<(), Failure<T>> {
        let task = StepTask {
            y,
            h,
            constrained,
            first: self.settings.first_alpha.unwrap_or(1),
            norm,
            alpha_bound: self.settings.alpha_bound,
            max_iterations: self.settings.max_iterations,
            pure: self.settings.pure_newton,
            repeat: T::EPSILON < T::ratio(1, 1 << 60),
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

    fn error(&mut self, failure: Failure<T>, y: &State<T>, time: T, step: T) -> IntegrateError<T> {
        let halvings = self.settings.max_halvings;
        let unsolved = matches!(
            failure,
            Failure::NotFinite | Failure::NoConvergence { .. } | Failure::Astray { .. }
        );
        if unsolved && let Some(size) = escapes(&mut self.energy, &y.hi, step) {
            return IntegrateError::Escape { time, step, size };
        }
        match failure {
            Failure::NotFinite => IntegrateError::NotFinite {
                time,
                step,
                halvings,
            },
            Failure::Singular => IntegrateError::Singular {
                time,
                step,
                halvings,
            },
            Failure::Astray { defect, scale } => IntegrateError::Astray {
                time,
                step,
                defect,
                scale,
            },
            Failure::NoConvergence {
                iterations,
                correction,
            } => IntegrateError::NoConvergence {
                time,
                step,
                halvings,
                iterations,
                correction,
            },
            Failure::NoAlpha | Failure::Unresolved => {
                let mut worst = (T::int(0), T::int(0));
                for c in &self.constraints {
                    if c.in_floors() > T::int(1) {
                        worst = (c.defect, c.floor);
                    }
                }
                IntegrateError::NoAdmissibleAlpha {
                    time,
                    step,
                    defect: worst.0,
                    floor: worst.1,
                }
            }
        }
    }
}

/// Whether sweeps can solve what is asked: the stages, with the energy as the only constraint; if they are to move the α's too, with
/// slopes for two of them or more. With the one that s = 3 leaves trajectories are up to 1000 times as far off as with both.
fn can_sweep<T: Float>(settings: &Settings<T>, s: usize, constraints: usize) -> bool {
    let has_slopes = settings.first_alpha == Some(1) && s > 3;
    let wanted = match settings.stage_solver {
        StageSolver::Automatic => constraints <= 1,
        StageSolver::Sweeps => constraints == 0 || (constraints == 1 && has_slopes),
        _ => false,
    };
    wanted && !settings.pure_newton
}
