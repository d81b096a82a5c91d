//! The step by sweeps: when they are tried, what they start from, and what they leave to Newton and to others.

use crate::checkpoint::SpringsMemory;
use crate::error::IntegrateError;
use crate::newton::nearly_met;
use crate::options::{Settings, StageSolver};
use crate::ready::ready;
use crate::springs::Springs;
use crate::state::State;
use crate::step::Core;
use crate::sweep_task::{Rule, SweepTask, Trouble};
use equip_autodiff::{Evaluate, Structure};
use equip_scalar::Float;

/// A gradient of H and where it was taken.
#[derive(Debug)]
pub(crate) struct KnownGradient<T> {
    pub(crate) y: Vec<T>,
    pub(crate) gradient: Vec<T>,
}

impl<T: Float> KnownGradient<T> {
    fn take<E: Evaluate<T>>(&mut self, energy: &mut E, y: &[T]) {
        self.y.copy_from_slice(y);
        energy.gradient(y, &mut self.gradient);
    }
}

/// Steps that a [`Pause`] has at most.
const MOST: u32 = 64;

/// Steps that sweeps are not tried for, Newton's or halved at once, before they are tried again: 1, 2, 4, … 64 while they fail.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pause {
    left: u32,
    next: u32,
}

impl Pause {
    pub(crate) const NONE: Self = Pause { left: 0, next: 1 };

    fn lengthen(&mut self) {
        self.left = self.next;
        self.next = (2 * self.next).min(MOST);
    }

    pub(crate) fn memory(&self) -> [u32; 2] {
        [self.left, self.next]
    }

    pub(crate) fn of([left, next]: [u32; 2]) -> Self {
        let next = next.clamp(1, MOST);
        Pause { left, next }
    }

    /// Whether this step is one of them.
    fn passes(&mut self) -> bool {
        let passes = self.left > 0;
        self.left -= u32::from(passes);
        passes
    }
}

/// What comes when sweeps do not solve a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Then {
    /// Its halves, of a step that has itself been halved so many times.
    Halves(usize),
    Newton,
    Nothing,
}

/// Local errors that α's by slopes may move the end point by where halves come next, and where Newton does.
const BEFORE_HALVES: f64 = 4.0;
const BEFORE_NEWTON: f64 = 64.0;

impl<T: Float, E: Evaluate<T>> Core<T, E> {
    /// For steps that are to be made backwards: Newton's α's are the same then to the last few bits, those by sweeps to 1e-16 … 1e-14.
    pub(crate) fn leave_alphas_to_newton(&mut self) {
        if self.settings.stage_solver != StageSolver::Sweeps {
            self.rule = Rule::Newton;
        }
    }

    /// Whether steps made backwards are to take the same α's by responses, to round-off. What sweeps leave to Newton he moves with no others then.
    pub(crate) fn is_to_return(&self) -> bool {
        let is_default = self.settings.stage_solver == StageSolver::Automatic;
        !T::IS_DOUBLE && is_default && self.rule == Rule::Response
    }

    /// What comes if sweeps do not solve a step of this level.
    pub(crate) fn then(&self, level: u32) -> Then {
        let is_alone = self.settings.stage_solver == StageSolver::Sweeps;
        let halves = is_alone || (self.rule == Rule::Slopes && self.pause.left == 0);
        if halves && level < self.settings.max_halvings {
            Then::Halves(level as usize)
        } else if is_alone {
            Then::Nothing
        } else {
            // Where many components move he takes as long as hundreds of sweeps and more.
            Then::Newton
        }
    }

    /// As [`find_springs`](Self::find_springs) has it done.
    pub(crate) fn look_for_springs(&mut self, structure: &Structure, (y, h): (&[T], T)) {
        let gauss = &self.stages.gauss;
        if let Some(sweeps) = &mut self.sweeps
            && T::IS_DOUBLE
            && self.start_alphas.iter().all(|&alpha| alpha == T::int(0))
            && let Some(w) = sweeps.iterate.kinetic.as_ref().and_then(|k| k.diagonal())
        {
            let pattern = (&*structure.hessian, w, !self.constraints.is_empty());
            let (springs, unresolved) = Springs::find(gauss, &mut self.energy, pattern, (y, h));
            sweeps.set_springs(springs);
            self.unresolved_spring = unresolved;
        }
    }

    pub(crate) fn springs_memory(&self) -> Option<SpringsMemory> {
        let sweeps = self.sweeps.as_ref()?;
        sweeps.iterate.springs.as_ref().map(Springs::memory)
    }

    /// A run of steps of size `h` is resumed, with the springs it began with.
    pub(crate) fn restore_springs(
        &mut self,
        structure: &Structure,
        (memory, h): (Option<&SpringsMemory>, T),
    ) -> Result<(), IntegrateError<T>> {
        self.leave_out_springs();
        if let (Some(sweeps), Some(memory)) = (&mut self.sweeps, memory)
            && let Some(w) = sweeps.iterate.kinetic.as_ref().and_then(|k| k.diagonal())
        {
            let found = Springs::from_memory((&*structure.hessian, w, h), memory)?;
            sweeps.set_springs(found);
        }
        Ok(())
    }

    /// The steps are of any size.
    pub(crate) fn leave_out_springs(&mut self) {
        self.unresolved_spring = None;
        if let Some(sweeps) = &mut self.sweeps {
            sweeps.set_springs(None);
        }
    }

    /// A run is resumed at `y`: what the step that led there knew is known again.
    pub(crate) fn resume_at(&mut self, y: &State<T>) {
        if !self.constraints.is_empty() && self.guess.is_from_last_step() {
            self.start.take(&mut self.energy, &y.hi);
        }
    }

    /// System (7) by sweeps, unless it is somebody else's turn. If they do not solve it `then` comes.
    pub(crate) fn sweep(
        &mut self,
        then: Then,
        (y, h): (&State<T>, T),
        constrained: bool,
        next: &mut State<T>,
    ) -> Result<(), Trouble> {
        let is_to_return = self.is_to_return();
        let Some(sweeps) = &mut self.sweeps else {
            return Err(Trouble::Slow);
        };
        let mut none = Pause::NONE;
        let pause = match then {
            Then::Halves(level) => &mut self.halved[level],
            Then::Newton => &mut self.pause,
            Then::Nothing => &mut none,
        };
        if pause.passes() {
            sweeps.contraction.seen = 0.0;
            return Err(Trouble::Slow);
        }
        if !self.constraints.is_empty() && self.start.y != y.hi {
            self.start.take(&mut self.energy, &y.hi);
            self.counts.gradients += 1;
        }
        let task = SweepTask {
            y,
            h,
            alphas: &self.start_alphas,
            alpha_bound: self.settings.alpha_bound,
            last: self.guess.prolongation(h),
            known: (!self.constraints.is_empty()).then_some(self.start.gradient.as_slice()),
            rule: self.rule,
            most_errors: match then {
                Then::Halves(_) => Some(BEFORE_HALVES),
                Then::Newton if self.settings.max_halvings == 0 => Some(BEFORE_NEWTON),
                // As small as it gets.
                _ => None,
            },
            is_to_return,
        };
        let constraint = self.constraints.first_mut().filter(|_| constrained);
        if !self.guess.is_swept() {
            sweeps.iterate.take_l(self.guess.last().0);
        }
        let swept = sweeps.solve(
            &self.stages.gauss,
            &mut self.energy,
            constraint,
            (next, &task),
            &mut self.counts,
        );
        match swept {
            Ok(()) => {
                self.pause = Pause::NONE;
                if let Then::Halves(level) = then {
                    self.halved[level..].fill(Pause::NONE);
                }
                let are_start = !sweeps.iterate.k_has_moved();
                self.stages.note_alphas(&sweeps.alphas, are_start);
                self.guess.remember_swept(h);
            }
            Err(trouble) => {
                self.guess.fetch(|l| sweeps.iterate.give_l_before(l));
                self.guess.is_lost();
                let by_slopes =
                    self.rule == Rule::Slopes && self.settings.stage_solver != StageSolver::Sweeps;
                match trouble {
                    Trouble::Slow => pause.lengthen(),
                    // They contracted.
                    Trouble::StagesOnly => *pause = Pause::NONE,
                    Trouble::NoAlpha if by_slopes && !nearly_met(&self.constraints) => {
                        pause.lengthen();
                    }
                    Trouble::NoAlpha => {}
                }
                if then != Then::Newton {
                    // What is tried next, in parts, starts from the state alone.
                    self.guess.forget();
                    return Err(trouble);
                }
                self.counts.taken_over += 1;
                if trouble == Trouble::StagesOnly {
                    (ready::<T>().give_z)(&mut sweeps.iterate, y, &mut self.stages.z);
                    self.guess.is_made();
                }
            }
        }
        swept
    }

    /// How the sweeps of the step made last contracted, if they were tried and are most of its work, as a power that goes like h: with the positions
    /// alone as unknowns a sweep is two.
    pub(crate) fn contraction(&self) -> Option<f64> {
        if self.rule == Rule::Newton && !self.constraints.is_empty() {
            return None;
        }
        let sweeps = self.sweeps.as_ref()?;
        let rate = sweeps.contraction.seen;
        let contraction = match sweeps.iterate.kinetic {
            Some(_) => rate.sqrt(),
            None => rate,
        };
        (contraction > 0.0).then_some(contraction)
    }

    /// L of the step made last component by component, if sweeps have made it.
    pub(crate) fn swept_l(&self) -> Option<&[T]> {
        let sweeps = self.sweeps.as_ref()?;
        self.guess.is_swept().then_some(&*sweeps.iterate.l)
    }

    /// Sees to it that L of the step made last stands in the stages and in the guess: sweeps keep it until somebody asks.
    pub(crate) fn fetch_l(&mut self) {
        let Some(sweeps) = &self.sweeps else {
            return;
        };
        if self.guess.is_swept() {
            self.guess.fetch(|l| sweeps.iterate.give_l(l));
            self.stages.l.copy_from_slice(self.guess.last().0);
        }
    }

    /// The same of Z, of a step from `y`, in the stages only.
    pub(crate) fn fetch_z(&mut self, y: &State<T>) {
        if let (Some(sweeps), true) = (&mut self.sweeps, self.guess.is_swept()) {
            (ready::<T>().give_z)(&mut sweeps.iterate, y, &mut self.stages.z);
        }
    }
}

/// Components from which on three α's can do so little about the error that responses are not worth their time (`docs/adr/0006-sweeps-first.md`).
const MANY_FOR_RESPONSES: usize = 24;

/// Who moves the α's of steps whose stages sweeps have found, for n components.
pub(crate) fn rule<T: Float>(
    settings: &Settings<T>,
    (s, n): (usize, usize),
    constraints: usize,
) -> Rule {
    let wanted = constraints == 1 && settings.first_alpha == Some(1) && s > 2;
    match settings.stage_solver {
        StageSolver::Sweeps => Rule::Slopes,
        StageSolver::Automatic if wanted && T::IS_DOUBLE && s > 3 && n >= MANY_FOR_RESPONSES => {
            Rule::Slopes
        }
        StageSolver::Automatic | StageSolver::Responses if wanted => Rule::Response,
        _ => Rule::Newton,
    }
}

/// Whether sweeps can solve what is asked: the stages, with the energy as the only constraint; if they are to move the α's too, with
/// slopes for two of them or more. With the one that s = 3 leaves trajectories are up to 1000 times as far off as with both.
pub(crate) fn can_sweep<T: Float>(settings: &Settings<T>, s: usize, constraints: usize) -> bool {
    let has_slopes = settings.first_alpha == Some(1) && s > 3;
    let wanted = match settings.stage_solver {
        StageSolver::Automatic | StageSolver::Responses => constraints <= 1,
        StageSolver::Sweeps => constraints == 0 || (constraints == 1 && has_slopes),
        _ => false,
    };
    wanted && !settings.pure_newton
}
