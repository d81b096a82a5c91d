//! The linearised stage equations, by full or by simplified Newton: which of the two, and how long a factorisation serves.
//!
//! *Full* ([`crate::linearisation`]): M at the current stages; a factorisation while corrections exceed ε^(1/3).
//!
//! *Simplified* ([`crate::simplified`]): one H̄, α = 0. Corrections contract by θ, the ratio of two successive ones. A factorisation serves
//! for as many steps as θ stays near what it was when fresh; above 1/2 it is made anew, and if that does not help
//! full Newton takes over for [`FULL_STEPS`] steps where it may.

use crate::checkpoint::{Exact, SolverMemory};
use crate::error::IntegrateError;
use crate::hessians::StageHessians;
use crate::linear::Singular;
use crate::linearisation::Linearisation;
use crate::options::StageSolver;
use crate::outcome::Counts;
use crate::simplified::Simplified;
use crate::stages::Stages;
use equip_autodiff::{Evaluate, Structure};
use equip_scalar::Float;
use nalgebra::DVector;

/// Simplified Newton's corrections that stop shrinking below this many ε are accepted as round-off.
const SLOW: i64 = 4096;
/// Up to this size s·n of the stage equations full Newton is as fast, …
const FULL_IS_FAST: usize = 32;
/// … and up to this where the α's have to be solved for, whose columns take M itself.
const FULL_IS_FAST_FOR_ALPHAS: usize = 128;
/// Up to this size full Newton may take over: 8 MB in f64.
const FULL_IS_POSSIBLE: usize = 1024;
/// Steps for which it does.
const FULL_STEPS: u32 = 16;
/// Simplified iterations allowed for each that is allowed to full Newton.
const ITERATIONS: u32 = 4;
/// Corrections below this many ε say nothing about θ.
const NOISE: i64 = 4096;

/// What to make of a correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Good,
    /// To be computed again: a new factorisation is due.
    Again,
    /// Corrections grow and nothing is left to try.
    Diverges,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Active {
    Full,
    Simplified,
}

#[derive(Debug)]
pub(crate) struct Linearised<T: Float> {
    choice: StageSolver,
    s: usize,
    pub(crate) hessians: StageHessians<T>,
    /// Made when first used.
    pub(crate) full: Option<Linearisation<T>>,
    pub(crate) simplified: Option<Simplified<T>>,
    active: Active,
    /// Steps still to be made by full Newton.
    full_steps: u32,
    /// Whether there is a simplified factorisation, and for which h.
    made_for: Option<T>,
    /// It was made near the solution of this step.
    fresh: bool,
    /// No correction has been made with it yet.
    untried: bool,
    /// A full factorisation is due whatever the corrections.
    full_due: bool,
    /// It has been asked for in this step.
    renewed: bool,
    /// Largest θ of this step, and of the step in which the factorisation was made.
    theta: T,
    theta_when_made: T,
    /// b, then b − M x.
    pub(crate) rest: DVector<T>,
    /// Correction of x.
    pub(crate) step: DVector<T>,
    pub(crate) parts: [Vec<T>; 2],
    pub(crate) work: DVector<T>,
    /// Relative error of the columns, with simplified Newton.
    pub(crate) columns_to: T,
}

impl<T: Float> Linearised<T> {
    pub(crate) fn new(
        s: usize,
        structure: &Structure,
        choice: StageSolver,
        constrained: bool,
    ) -> Self {
        let n = structure.hessian.dimension();
        let fast = if constrained {
            FULL_IS_FAST_FOR_ALPHAS
        } else {
            FULL_IS_FAST
        };
        let simplified = match choice {
            StageSolver::FullNewton => None,
            StageSolver::SimplifiedNewton => Simplified::new(s, structure),
            _ if s * n <= fast => None,
            _ => Simplified::new(s, structure),
        };
        let length = if simplified.is_some() { s * n } else { 0 };
        let zero = T::int(0);
        Linearised {
            choice,
            s,
            hessians: StageHessians::new(s, structure.hessian.to_pattern()),
            full: None,
            active: Active::Full,
            full_steps: 0,
            made_for: None,
            fresh: false,
            untried: false,
            full_due: false,
            renewed: false,
            theta: zero,
            theta_when_made: zero,
            rest: DVector::zeros(length),
            step: DVector::zeros(length),
            parts: [vec![zero; n], vec![zero; n]],
            work: DVector::zeros(s * n),
            columns_to: T::EPSILON.sqrt(),
            simplified,
        }
    }

    /// Forgets everything that was kept from earlier steps.
    pub(crate) fn forget(&mut self) {
        self.made_for = None;
        self.full_steps = 0;
        self.theta = T::int(0);
    }

    /// What is kept from earlier steps.
    pub(crate) fn memory(&self) -> SolverMemory {
        let mut memory = SolverMemory {
            full_steps: self.full_steps,
            made_for: self.made_for.map(Exact::of),
            theta: [self.theta, self.theta_when_made].map(Exact::of),
            untried: self.untried,
            ..SolverMemory::default()
        };
        if let (Some(simplified), Some(_)) = (&self.simplified, self.made_for) {
            simplified.save(&mut memory);
        }
        memory
    }

    pub(crate) fn restore(&mut self, memory: &SolverMemory) -> Result<(), IntegrateError<T>> {
        self.full_steps = memory.full_steps;
        self.theta = memory.theta[0].read()?;
        self.theta_when_made = memory.theta[1].read()?;
        self.untried = memory.untried;
        self.made_for = match (&mut self.simplified, &memory.made_for) {
            (Some(simplified), Some(h)) => {
                simplified.restore(memory)?;
                Some(h.read()?)
            }
            _ => None,
        };
        Ok(())
    }

    /// A step of size `h` begins; `pure` asks for a factorisation in every iteration.
    pub(crate) fn begin(&mut self, h: T, pure: bool) {
        let full =
            self.simplified.is_none() || (self.may_switch() && (pure || self.full_steps > 0));
        self.full_steps = self.full_steps.saturating_sub(1);
        self.active = if full {
            Active::Full
        } else {
            Active::Simplified
        };
        let worn = T::ratio(1, 10).max(T::int(2) * self.theta_when_made);
        if self.theta > worn || self.made_for != Some(h) {
            self.made_for = None;
        }
        self.theta = T::int(0);
        self.fresh = false;
        self.full_due = false;
        self.renewed = false;
        self.columns_to = T::EPSILON.sqrt();
    }

    /// For the rest of the step: the relative error of the columns of α's, √ε unless it is set.
    pub(crate) fn columns_to(&mut self, tolerance: T) {
        self.columns_to = tolerance;
    }

    /// Whether there is simplified Newton to use.
    pub(crate) fn has_simplified(&self) -> bool {
        self.simplified.is_some()
    }

    pub(crate) fn is_simplified(&self) -> bool {
        self.active == Active::Simplified
    }

    /// How many iterations a step may take.
    pub(crate) fn iteration_limit(&self, full: u32) -> u32 {
        match self.simplified {
            Some(_) => full.saturating_mul(ITERATIONS),
            None => full,
        }
    }

    /// Sees to it that there is a factorisation to correct with; `last` is the size of the last correction.
    pub(crate) fn refresh<E: Evaluate<T>>(
        &mut self,
        stages: &Stages<T>,
        energy: &mut E,
        (h, last, pure): (T, T, bool),
        counts: &mut Counts,
    ) -> Result<(), Singular> {
        match (self.active, &mut self.simplified) {
            (Active::Simplified, Some(simplified)) => {
                let serves = simplified.rescale(stages) && self.made_for.is_some();
                if !serves || pure {
                    self.made_for = None;
                    simplified.refresh(stages, energy, h, counts)?;
                    self.made_for = Some(h);
                    self.fresh = last <= T::ratio(1, 100);
                    self.untried = true;
                    self.theta_when_made = T::int(0);
                    simplified.rescale(stages);
                }
            }
            _ if last > T::EPSILON.cbrt() || pure || self.full_due => {
                self.full_due = false;
                self.hessians.take(stages, energy, h, counts);
                counts.factorisations += 1;
                let (s, n) = (self.s, stages.n);
                self.full
                    .get_or_insert_with(|| Linearisation::new(s, n))
                    .refresh(stages, &self.hessians)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Judges a correction by the one before it.
    pub(crate) fn judge(&mut self, size: T, last: T) -> Verdict {
        if !self.is_simplified() || !size.is_finite() {
            return Verdict::Good;
        }
        // The first with a factorisation says nothing about it.
        let untried = std::mem::replace(&mut self.untried, false);
        if untried || !last.is_finite() || size <= T::int(NOISE) * T::EPSILON {
            return Verdict::Good;
        }
        let theta = size / last;
        if theta > T::ratio(1, 2) {
            if !self.fresh {
                self.made_for = None;
                return Verdict::Again;
            }
            if self.take_over() {
                self.full_due = true;
                return Verdict::Again;
            }
            if theta > T::int(1) {
                return Verdict::Diverges;
            }
        }
        self.theta = self.theta.max(theta);
        if self.fresh {
            self.theta_when_made = self.theta;
        }
        Verdict::Good
    }

    /// Hands over to full Newton for some steps, if it may. Returns whether it does.
    pub(crate) fn take_over(&mut self) -> bool {
        let possible = self.may_be_taken_over();
        if possible {
            self.active = Active::Full;
            self.full_steps = FULL_STEPS;
            self.made_for = None;
        }
        possible
    }

    /// Whether the user leaves the kind of Newton to us.
    fn may_switch(&self) -> bool {
        self.choice != StageSolver::SimplifiedNewton
    }

    /// Whether there is full Newton to hand over to.
    pub(crate) fn may_be_taken_over(&self) -> bool {
        self.may_switch() && self.is_simplified() && self.work.len() <= FULL_IS_POSSIBLE
    }

    /// Asks full Newton for a factorisation at the current stages, once in a step. Returns whether there will be one.
    pub(crate) fn renew(&mut self) -> bool {
        let possible = !self.is_simplified() && !self.renewed;
        self.renewed = true;
        self.full_due |= possible;
        possible
    }

    /// A correction had to be shortened: the factorisation is not to be trusted.
    pub(crate) fn distrust(&mut self) {
        self.made_for = None;
    }

    /// Whether corrections no longer shrink because they are round-off. Below √ε full Newton's would by far more
    /// than 4, were they not (in stiff springs rounding is 1e-11 of the state); simplified Newton's may just be slow.
    pub(crate) fn stagnates(&self, size: T, last: T) -> bool {
        let (share, limit) = if self.is_simplified() {
            (T::ratio(3, 4), T::int(SLOW) * T::EPSILON)
        } else {
            (T::ratio(1, 4), T::EPSILON.sqrt())
        };
        size > share * last && size <= limit
    }

    /// What a correction of this size leaves of the error.
    pub(crate) fn rest_of(&self, size: T) -> T {
        if self.is_simplified() {
            size * self.theta.max(self.theta_when_made).max(size)
        } else {
            size * size
        }
    }

    /// Correction of the stages for the right-hand side x, in place.
    pub(crate) fn solve(&mut self, x: &mut DVector<T>) {
        match (self.active, &mut self.simplified, &mut self.full) {
            (Active::Simplified, Some(simplified), _) => simplified.solve(x),
            (_, _, Some(full)) => full.solve(x),
            _ => {}
        }
    }

    /// How the end point moves with the stages, in units of the state; to θ with simplified Newton.
    pub(crate) fn end_displacement(&mut self, stages: &Stages<T>, x: &DVector<T>, u: &mut [T]) {
        match (self.active, &mut self.simplified) {
            (Active::Simplified, Some(simplified)) => simplified.end_displacement(stages, x, u),
            _ => self.hessians.end_displacement(stages, x, u),
        }
    }
}
