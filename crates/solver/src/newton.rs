//! Full Newton on system (7): stages Z and the free α's together, by block elimination.
//!
//! Linearising  Z − K(α) L(Z) = 0,  H(y0 + Σ L_i) − H_ref = 0  gives the bordered system
//!
//! $$ M\,\delta Z - \sum_k (T_k L)\,\delta\alpha_k = -R, \qquad
//!    \nabla H(y_1)^T \sum_i B_i\,\delta Z_i = -g. $$
//!
//! With δα = t d along the direction of least displacement ([`crate::alpha`]) the border is one column: solve for −R and for
//! Σ d_k T_k L with one factorisation of M ([`crate::linearised`]), then t from the last row. Every further invariant to be
//! kept adds a row, a direction and a column ([`crate::constraint`]).
//!
//! *Start.* At Z = 0 all T_k L vanish and the border is singular, so the stages are solved with α = 0 first, with damping
//! while they are far. The α's move only when the predicted |g| stands out of the error that the stages still have.
//! *End.* Both residuals are driven to round-off: until corrections are at ε/64 or, below √ε, stop shrinking
//! (there Newton contracts, so what does not shrink is rounding; in stiff springs it is 1e-11 of the state), and |g| is at its floor or
//! stops shrinking near it.
//!
//! With simplified Newton a cheaper matrix stands in for M and corrections shrink linearly; what is solved is the same.
//!
//! Cost per iteration: that of [`crate::linearised`], s gradients, and one more per constraint once the stages are near.

use crate::alpha::{Directions, Moved, Norm};
use crate::constraint::{Constraint, worst};
use crate::displacement::dot;
use crate::failure::{Damaged, Failure};
use crate::linearised::{Linearised, Verdict};
use crate::local_error::LocalError;
use crate::memory::SolverMemory;
use crate::newton_alphas::{EACH_PASS, MAX_PASSES, Passes};
use crate::one_more::OneMore;
use crate::options::StageSolver;
use crate::outcome::Counts;
use crate::slow::{LARGEST, Slow};
use crate::stages::Stages;
use crate::state::State;
use equip_autodiff::{Evaluate, Structure};
use equip_scalar::Float;
use nalgebra::DVector;

/// Corrections below ε over this are of no account. What is left of Z − K L is an error of quadratic invariants that repeats from period to
/// period.
const CONVERGED: i64 = 64;
/// Corrections above this many ε that stop shrinking are made again with a new factorisation before they are taken for round-off.
const OUT_OF_DATE: i64 = 64;
/// Energy defects that stop shrinking below this many floors are accepted as round-off. One less than the 8 that are
/// promised: evaluating H rounds as well.
pub(crate) const ENERGY_STAGNATED: i64 = 7;
/// Dampings of one correction, each to half the step.
const MAX_DAMPINGS: u32 = 6;
/// α's shortened by their bound this often in one step: no admissible α.
const MAX_SHORTENED: u32 = 3;

/// What is fixed while a step is solved.
#[derive(Debug)]
pub(crate) struct StepTask<'a, T> {
    pub(crate) y: &'a State<T>,
    pub(crate) h: T,
    /// Whether the constraints are to be met; if not, the α's stay where they are.
    pub(crate) constrained: bool,
    /// Free are α_first … α_{end − 1}; end is s unless the last ones are left out.
    pub(crate) first: usize,
    pub(crate) end: usize,
    pub(crate) norm: Norm,
    pub(crate) alpha_bound: T,
    pub(crate) max_iterations: u32,
    /// Factor anew in every iteration, and let the α's join as early as they can. For studies.
    pub(crate) pure: bool,
    /// Take the directions of the α's again at the stages that they have led to, until that moves nothing.
    pub(crate) repeat: bool,
}

/// One Newton iteration, as it is seen before its correction is applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonRecord<T> {
    /// Correction of the stages that −R asks for, relative to the state: the error of the stages.
    pub correction: T,
    /// g = H(y1) − H_ref; zero while the stages are far, or when the energy is not asked for.
    pub energy_defect: T,
}

#[derive(Debug)]
pub(crate) struct Newton<T: Float> {
    pub(crate) linearised: Linearised<T>,
    pub(crate) directions: Directions<T>,
    /// `None` where there is nothing to choose between α's.
    pub(crate) local_error: Option<LocalError<T>>,
    /// The correction δZ, in units of `Stages::scale`, and a second column.
    pub(crate) correction: DVector<T>,
    column: DVector<T>,
    pub(crate) moved_end: Vec<T>,
    /// `None` where there is nothing to choose between α's, or too much to do.
    pub(crate) slow: Option<Slow<T>>,
    /// Iterations of the step solved last.
    pub(crate) history: Vec<NewtonRecord<T>>,
}

impl<T: Float> Newton<T> {
    /// For the nodes of `gauss` and so many constraints, solved with `free` α's.
    pub(crate) fn new(
        s: usize,
        finer: Option<&OneMore<T>>,
        structure: &Structure,
        solver: StageSolver,
        (constraints, free): (usize, usize),
        max_iterations: u32,
    ) -> Self {
        let n = structure.hessian.dimension();
        let linearised = Linearised::new(s, structure, solver, constraints > 0);
        let limit = linearised.iteration_limit(max_iterations);
        let choice = constraints > 0 && free > 1;
        let simplified = linearised.has_simplified();
        Newton {
            local_error: finer.map(|finer| LocalError::new(finer.clone(), structure, simplified)),
            linearised,
            slow: (choice && n <= LARGEST).then(|| Slow::new(&structure.hessian)),
            directions: Directions::new(s, n, constraints),
            correction: DVector::zeros(s * n),
            column: DVector::zeros(s * n),
            moved_end: vec![T::int(0); n],
            history: Vec::with_capacity((limit + MAX_PASSES * EACH_PASS) as usize),
        }
    }

    /// Forgets what was kept of earlier steps.
    pub(crate) fn forget(&mut self) {
        self.linearised.forget();
    }

    /// What is kept of earlier steps.
    pub(crate) fn save(&self, memory: &mut SolverMemory<T>) {
        self.linearised.save(memory);
    }

    pub(crate) fn restore(&mut self, memory: &SolverMemory<T>) -> Result<(), Damaged> {
        self.linearised.restore(memory)
    }

    /// After a failure: whether full Newton takes over, so that the step may be tried again.
    pub(crate) fn take_over(&mut self) -> bool {
        self.linearised.take_over()
    }

    /// Solves for Z (and the α's, if there are constraints) from the guess in `stages`; on success `stages` holds
    /// the solution with its L, `next` the end point and the constraints their defects there.
    pub(crate) fn solve<E: Evaluate<T>>(
        &mut self,
        stages: &mut Stages<T>,
        constraints: &mut [Constraint<T>],
        next: &mut State<T>,
        energy: &mut E,
        task: &StepTask<'_, T>,
        counts: &mut Counts,
    ) -> Result<(), Failure<T>> {
        self.history.clear();
        self.directions.forget();
        self.linearised.begin(task.h, task.pure);
        let mut solution = Solution {
            stages,
            constraints,
            next,
            energy,
            counts,
        };
        let solved = self.iterate(&mut solution, task);
        // The stages alone were within reach when the α's began to move: what failed since, failed for them, unless
        // simplified Newton is to blame.
        let moved = self.directions.are_known() && !self.linearised.may_be_taken_over();
        // Smaller steps would not resolve it either, and other α's would disturb it more.
        let at_rest =
            moved && task.norm == Norm::Slow && self.fast_motion_is_at_rest(solution.stages);
        solved.map_err(|failure| match failure {
            Failure::Unresolved => failure,
            _ if at_rest => Failure::Unresolved,
            _ if moved => Failure::NoAlpha,
            _ => failure,
        })
    }

    fn iterate<E: Evaluate<T>>(
        &mut self,
        at: &mut Solution<'_, T, E>,
        task: &StepTask<'_, T>,
    ) -> Result<(), Failure<T>> {
        let eps = T::EPSILON;
        let (near, reuse) = (T::ratio(1, 100), eps.cbrt());
        let (mut last, mut last_out) = (T::INFINITY, T::INFINITY);
        let mut shortened = 0;
        let mut passes = Passes::new(task.repeat);
        finite(at.evaluate(task))?;
        let limit = self.linearised.iteration_limit(task.max_iterations);
        let mut left = limit;
        while left > 0 {
            left -= 1;
            at.counts.newton_iterations += 1;
            if last > reuse || task.pure {
                at.stages.measure(task.y, last > near);
            }
            let size = self.correct(at, task, last)?;
            if size > near && !self.directions.are_known() {
                self.history.push(NewtonRecord {
                    correction: size,
                    energy_defect: T::int(0),
                });
                self.damped_update(at, task, size)?;
                last = size;
                continue;
            }

            let stagnates = size <= eps.sqrt() && self.linearised.stagnates(size, last);
            // A factorisation that is out of date looks the same.
            if stagnates && size > T::int(OUT_OF_DATE) * eps && self.linearised.renew() {
                last = T::INFINITY;
                continue;
            }
            let round_off = size <= eps / T::int(CONVERGED) || stagnates;
            at.stages.end_point(task.y, at.next);
            let mut out = T::int(0);
            if task.constrained {
                self.end_correction(at.stages);
                out = self.meet_constraints(at, round_off)?;
            }
            let defect = at
                .constraints
                .first()
                .filter(|_| task.constrained)
                .map(|c| c.defect);
            self.history.push(NewtonRecord {
                correction: size,
                energy_defect: defect.unwrap_or(T::int(0)),
            });
            if round_off {
                let stalls = out <= T::int(ENERGY_STAGNATED) && out > last_out / T::int(2);
                if out <= T::int(1) || stalls {
                    if !self.are_admissible(at.stages, task.first) {
                        return Err(Failure::Unresolved);
                    }
                    if !(passes.are_due() && self.directions.are_a_choice()) {
                        return Ok(());
                    }
                    self.take_again(at, task)?;
                    last = self.correction.amax();
                    passes.made(last);
                    left += EACH_PASS;
                    last_out = T::INFINITY;
                    at.stages.add(T::int(1), self.correction.as_slice());
                    finite(at.evaluate(task))?;
                    continue;
                }
                last_out = out;
            }
            if out > T::int(1) {
                match self.move_alphas(at, task, (size, last)) {
                    Moved::NotAtAll => return Err(Failure::NoAlpha),
                    Moved::ToBound => shortened += 1,
                    Moved::Fully | Moved::NotYet => {}
                }
                // Round-off that only a large α would remove is not worth a second try.
                let round_off = shortened > 0 && nearly_met(at.constraints);
                if round_off || shortened == MAX_SHORTENED {
                    return Err(Failure::NoAlpha);
                }
            }
            last = self.correction.amax();
            at.stages.add(T::int(1), self.correction.as_slice());
            finite(at.evaluate(task))?;
        }
        Err(Failure::NoConvergence {
            iterations: limit,
            correction: last,
        })
    }

    /// The correction of the stages for −R, made with a linearisation that is good enough; its size.
    fn correct<E: Evaluate<T>>(
        &mut self,
        at: &mut Solution<'_, T, E>,
        task: &StepTask<'_, T>,
        last: T,
    ) -> Result<T, Failure<T>> {
        loop {
            self.linearised
                .refresh(at.stages, at.energy, (task.h, last, task.pure), at.counts)
                .map_err(|_| Failure::Singular)?;
            at.stages.residual(self.correction.as_mut_slice());
            self.linearised.solve(&mut self.correction);
            let size = self.correction.amax();
            finite(size.is_finite())?;
            match self.linearised.judge(size, last) {
                Verdict::Good => return Ok(size),
                Verdict::Again => {}
                Verdict::Diverges => {
                    return Err(Failure::NoConvergence {
                        iterations: self.history.len() as u32,
                        correction: size,
                    });
                }
            }
        }
    }

    /// Far from the solution: the longest of the steps 1, 1/2, 1/4, … that makes the next correction with the same
    /// factorisation smaller (natural monotonicity test, Deuflhard 1974).
    fn damped_update<E: Evaluate<T>>(
        &mut self,
        at: &mut Solution<'_, T, E>,
        task: &StepTask<'_, T>,
        size: T,
    ) -> Result<(), Failure<T>> {
        let mut step = T::int(1);
        at.stages.add(step, self.correction.as_slice());
        for _ in 0..MAX_DAMPINGS {
            if at.evaluate(task) {
                at.stages.residual(self.column.as_mut_slice());
                self.linearised.solve(&mut self.column);
                if self.column.amax() <= (T::int(1) - step / T::int(4)) * size {
                    return Ok(());
                }
            }
            // Take back half of what was added.
            self.linearised.distrust();
            step /= T::int(2);
            at.stages.add(-step, self.correction.as_slice());
        }
        Err(Failure::NoConvergence {
            iterations: self.history.len() as u32,
            correction: size,
        })
    }

    /// Evaluates the constraints at the end point; returns the worst defect in floors.
    fn meet_constraints<E: Evaluate<T>>(
        &self,
        at: &mut Solution<'_, T, E>,
        round_off: bool,
    ) -> Result<T, Failure<T>> {
        for c in at.constraints.iter_mut() {
            at.counts.gradients += 1;
            finite(c.evaluate(at.energy, at.next, &at.stages.scale))?;
            c.predicted = c.defect + dot(&c.gradient, &self.moved_end);
            if round_off {
                c.add_stage_noise(&self.moved_end);
            }
        }
        Ok(worst(at.constraints, Constraint::in_floors))
    }

    /// How the end point moves with the correction of the stages.
    fn end_correction(&mut self, stages: &Stages<T>) {
        self.linearised
            .end_displacement(stages, &self.correction, &mut self.moved_end);
        stages.end_displacement_by_stages(self.correction.as_slice(), &mut self.moved_end);
    }
}

/// What a step is solved for and with, lent out for the duration of the solve.
pub(crate) struct Solution<'a, T: Float, E> {
    pub(crate) stages: &'a mut Stages<T>,
    pub(crate) constraints: &'a mut [Constraint<T>],
    pub(crate) next: &'a mut State<T>,
    pub(crate) energy: &'a mut E,
    pub(crate) counts: &'a mut Counts,
}

impl<T: Float, E: Evaluate<T>> Solution<'_, T, E> {
    fn evaluate(&mut self, task: &StepTask<'_, T>) -> bool {
        self.stages
            .evaluate(self.energy, task.y, task.h, self.counts)
    }
}

/// Whether a step with α = 0 leaves no more than a few floors of defect.
pub(crate) fn nearly_met<T: Float>(constraints: &[Constraint<T>]) -> bool {
    worst(constraints, Constraint::without_alpha_in_floors) <= T::int(ENERGY_STAGNATED)
}

fn finite<T>(ok: bool) -> Result<(), Failure<T>> {
    if ok { Ok(()) } else { Err(Failure::NotFinite) }
}
