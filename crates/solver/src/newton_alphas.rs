//! Newton's part for the α's: when they move, and which way.
//!
//! The directions are taken once the stages with α = 0 are there ([`crate::alpha`]), which is enough for the step: the energy is kept and the
//! end as near to the exact flow as α's can bring it, to first order. The step backwards meets these stages to first order only, so a
//! run comes back to where it started to the square of what the α's move.
//!
//! *Repeated.* Where the number type has the digits for more, the directions are taken again at the stages that the α's have led to, whose Hessians,
//! displacements and local error are those of the step backwards to the last digit: the α's wanted are a fixed point of
//! this, α = α⁰(α) + D(α) t. Measured on Kepler's problem, e = 0.6, s = 6: each pass moves the stages by 1/150 of what the last has.
//!
//! Cost of a pass: a factorisation, two solves per free α, a local error, and two or three iterations.

use crate::alpha::{Moved, Norm};
use crate::constraint::{Constraint, worst};
use crate::failure::Failure;
use crate::newton::{Newton, Solution, StepTask};
use crate::stages::Stages;
use equip_autodiff::Evaluate;
use equip_scalar::Float;

/// Last Legendre coefficient, and the one before it, of stage derivatives relative to the state: above one of these the fast motion swings, …
const SWINGS: [(i64, i64); 2] = [(1, 2), (1, 1)];
/// … below both of these it is at rest.
const AT_REST: [(i64, i64); 2] = [(1, 32), (1, 4)];
/// Slow motion may be disturbed by a² over this.
const DISTURBED: i64 = 1000;

/// Passes made at most.
pub(crate) const MAX_PASSES: u32 = 8;
/// Iterations allowed for each.
pub(crate) const EACH_PASS: u32 = 8;

/// Passes over the directions of the α's in one step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Passes<T> {
    left: u32,
    /// How far the last one has moved the stages.
    last: Option<T>,
}

impl<T: Float> Passes<T> {
    pub(crate) fn new(wanted: bool) -> Self {
        Passes {
            left: if wanted { MAX_PASSES } else { 0 },
            last: None,
        }
    }

    pub(crate) fn are_due(self) -> bool {
        self.left > 0
    }

    /// One has moved the stages by `size`; another is of use if what it would move is above rounding.
    pub(crate) fn made(&mut self, size: T) {
        let factor = match self.last {
            Some(last) => size / last,
            None => size.sqrt(),
        };
        self.left = if size * factor <= T::EPSILON {
            0
        } else {
            self.left - 1
        };
        self.last = Some(size);
    }
}

impl<T: Float> Newton<T> {
    /// Moves the free α's along their directions if a predicted defect stands out of the error of the stages, and
    /// adds their part to the correction.
    pub(crate) fn move_alphas<E: Evaluate<T>>(
        &mut self,
        at: &mut Solution<'_, T, E>,
        task: &StepTask<'_, T>,
        (size, last): (T, T),
    ) -> Moved {
        // What the directions are taken from has to be better known than what moves along them.
        let exact = self.directions.are_known() || size <= T::int(64) * T::EPSILON;
        let margin = if exact { 4 } else { 1 << 20 };
        let uncertain = T::int(margin) * self.linearised.rest_of(size);
        let stands_out = |c: &Constraint<T>| c.predicted.abs() > c.floor.max(uncertain * c.scale);
        // The directions must not depend on how far the stages have come: wait until they are there.
        let early = size > T::EPSILON.sqrt() && !self.directions.are_known() && !task.pure;
        if early || !at.constraints.iter().any(stands_out) {
            return Moved::NotYet;
        }
        self.directions.judge_columns(at.constraints);
        let first = !self.directions.are_known();
        // The error of the directions times the displacement: what a step backwards would not undo.
        let defect = worst(at.constraints, |c| c.predicted.abs() / c.scale);
        let choice = task.end > task.first + 1;
        let stale = first && choice && !task.pure && T::int(16) * last * defect > T::EPSILON;
        if self.directions.columns_are_due()
            && !(self.linearised).prepare_columns(at.stages, at.energy, (task.h, stale), at.counts)
        {
            return Moved::NotAtAll;
        }
        if first {
            for c in at.constraints.iter_mut() {
                at.counts.gradients += 1;
                c.evaluate_start(at.energy, task.y);
                c.without_alpha = c.predicted;
            }
            if !self.take_directions(at, task, false) {
                return Moved::NotAtAll;
            }
        }
        self.step_along(at, task)
    }

    /// Takes the directions anew at the stages that the α's have led to, and moves the α's by what that changes.
    pub(crate) fn take_again<E: Evaluate<T>>(
        &mut self,
        at: &mut Solution<'_, T, E>,
        task: &StepTask<'_, T>,
    ) -> Result<(), Failure<T>> {
        self.linearised.columns_to(T::int(64) * T::EPSILON);
        let taken =
            (self.linearised).prepare_columns(at.stages, at.energy, (task.h, true), at.counts)
                && self.take_directions(at, task, true);
        match taken.then(|| self.step_along(at, task)) {
            Some(Moved::Fully | Moved::NotYet) => Ok(()),
            _ => Err(Failure::NoAlpha),
        }
    }

    /// Takes the directions at the current stages, which the α's have led to if `again`. Returns whether they were found.
    fn take_directions<E: Evaluate<T>>(
        &mut self,
        at: &mut Solution<'_, T, E>,
        task: &StepTask<'_, T>,
        again: bool,
    ) -> bool {
        let free = task.first..task.end;
        at.counts.alpha_solves += 2 * free.len() as u64;
        let (linearised, wanted) = (&mut self.linearised, task.norm);
        let mut of_use = (self.directions).begin(at.stages, linearised, &free, wanted);
        let unresolved = self.directions.are_of_unresolved_motion(0);
        let mut slow = self.slow.as_mut().filter(|_| unresolved);
        if let Some(filters) = &mut slow {
            let (ends, sizes) = ((&*task.y.hi, &*at.next.hi), self.directions.sizes());
            at.counts.hessians += 2;
            if !filters.take(at.energy, ends, task.h, sizes) {
                slow = None;
            } else if wanted == Norm::Slow {
                self.directions.count_slow_motion();
                of_use = false;
            }
        }
        let local = self.local_error.as_mut().filter(|_| of_use);
        let step = (task.y, task.h);
        let error = local.and_then(|local| {
            local.estimate(at.stages, &self.moved_end, at.energy, step, at.counts)
        });
        (self.directions).take(
            at.stages,
            linearised,
            (free, again),
            at.constraints,
            error,
            slow,
        )
    }

    /// Whether the α's leave in peace the slow motion of a step that does not resolve the fast one.
    ///
    /// The last Legendre coefficient a of the stage derivatives is how much of the fast motion there is. Where it swings, Gauss has the slow motion
    /// wrong by more than the α's do. Where it is at rest, slow motion feels it to O(a²) only, and would feel the α's.
    pub(crate) fn are_admissible(&self, stages: &Stages<T>, first: usize) -> bool {
        if !self.is_unresolved() {
            return true;
        }
        let [a, before] = self.last_coefficients(stages);
        let [most, most_before] = SWINGS.map(|(n, d)| T::ratio(n, d));
        let moved = self
            .directions
            .slow_displacement(&stages.alphas[first - 1..]);
        a > most || before > most_before || moved <= T::ratio(1, DISTURBED) * a * a
    }

    fn last_coefficients(&self, stages: &Stages<T>) -> [T; 2] {
        [1, 2].map(|from_last| stages.coefficient(from_last, self.directions.sizes()))
    }

    /// Whether there is fast motion that the step does not resolve, but which hardly swings.
    pub(crate) fn fast_motion_is_at_rest(&self, stages: &Stages<T>) -> bool {
        let [most, most_before] = AT_REST.map(|(n, d)| T::ratio(n, d));
        let [a, before] = self.last_coefficients(stages);
        self.is_unresolved() && a <= most && before <= most_before
    }

    /// Whether the step did not resolve all motion, and how much of it is slow is known.
    fn is_unresolved(&self) -> bool {
        let choice = self.directions.are_a_choice();
        self.slow.is_some() && choice && self.directions.are_of_unresolved_motion(0)
    }

    /// Whether that step would not resolve all motion if it were halved so often.
    pub(crate) fn stays_unresolved(&self, halvings: u32) -> bool {
        self.directions.are_of_unresolved_motion(halvings)
    }

    /// Whether Newton's last step did not resolve all motion: nothing can be prolonged from it.
    pub(crate) fn met_unresolved_motion(&self) -> bool {
        self.linearised.is_unresolved()
    }

    fn step_along<E: Evaluate<T>>(
        &mut self,
        at: &mut Solution<'_, T, E>,
        task: &StepTask<'_, T>,
    ) -> Moved {
        if self.directions.columns_are_due() {
            at.counts.alpha_solves += at.constraints.len() as u64;
        }
        self.directions.step(
            at.stages,
            &mut self.linearised,
            at.constraints,
            task.alpha_bound,
            &mut self.correction,
        )
    }
}
