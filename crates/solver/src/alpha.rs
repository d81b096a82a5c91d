//! The α part: which way the free α's move to bring g to zero.
//!
//! One equation (or a few, with further invariants to keep) for up to s − 1 unknowns. The α's move to
//!
//! $$ \alpha = \alpha^0 + D t, $$
//!
//! α⁰ being those that cancel most of the step's own local error and the columns of D, one for each equation, the cheapest
//! ways to change g ([`crate::displacement`]); t is solved for together with the stages. No direction changes when an
//! α is rescaled, and a vanishing slope costs nothing while another does not vanish.
//!
//! *Symmetry in time.* Everything is a mean over the two ends of the step and is taken once, when the stages with α = 0 have
//! converged, so the step backwards takes the same.

use crate::constraint::{Constraint, worst};
use crate::displacement::{Displacements, dot};
use crate::linear::DenseLu;
use crate::linearised::Linearised;
use crate::slow::Slow;
use crate::stages::Stages;
use equip_scalar::Float;
use nalgebra::DVector;
use std::ops::Range;

/// Columns solved for at stages that have moved by more than 1/1000 since are solved for anew.
const FAR: i64 = 1000;

/// Columns that bring a defect down by less than this are solved for anew.
const SLOW: i64 = 32;

/// Which displacements count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Norm {
    /// Where the step does not resolve all motion, the slow part alone ([`crate::slow`]); else as `Resolved`.
    Slow,
    /// Resolved motion in full, unresolved motion with 1/(1 + (hω)²), and the local error is aimed at.
    Resolved,
    /// All components alike, least displacement: the last try, where the others need too large an α.
    Plain,
}

/// What came of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Moved {
    /// Not yet: g does not stand out of the error that the stages still have.
    NotYet,
    /// As wanted.
    Fully,
    /// Shortened to stay within the bound.
    ToBound,
    /// The slope vanishes.
    NotAtAll,
}

/// Directions of the free α's and workspace for them.
#[derive(Debug)]
pub(crate) struct Directions<T: Float> {
    /// d of each constraint: d_1 … d_{s−1}, zero where the α is not free.
    d: Vec<Vec<T>>,
    known: bool,
    /// Whether there was more than one α to take them from.
    choice: bool,
    /// α⁰, or what α⁰ has still to change, and whether the α's have still to move there.
    base: Vec<T>,
    base_due: bool,
    displacements: Displacements<T>,
    resolution: Vec<T>,
    sizes: Vec<T>,
    u: Vec<T>,
    back: Vec<T>,
    /// ∂Z and ∂y1 of the move by α⁰.
    base_column: DVector<T>,
    base_end: Vec<T>,
    /// ∂Z/∂t of each constraint's direction, in units of the state.
    columns: Vec<DVector<T>>,
    /// ∂y1/∂t of each constraint's direction.
    ends: Vec<Vec<T>>,
    /// Whether the columns of this step's directions are known and kept.
    columns_known: bool,
    /// Worst predicted defect, relative, at the last move.
    last_defect: T,
    /// dg/dt, and the moves t.
    slopes: DenseLu<T>,
    t: DVector<T>,
    /// δα of the last move.
    delta: Vec<T>,
}

impl<T: Float> Directions<T> {
    pub(crate) fn new(s: usize, n: usize, constraints: usize) -> Self {
        let zeros = |len: usize| vec![T::int(0); len];
        Directions {
            d: vec![zeros(s - 1); constraints],
            known: false,
            choice: false,
            base: zeros(s - 1),
            base_due: false,
            displacements: Displacements::new(s, n, constraints),
            base_column: DVector::zeros(s * n),
            base_end: zeros(n),
            resolution: zeros(n),
            sizes: zeros(n),
            u: zeros(n),
            back: zeros(n),
            columns: vec![DVector::zeros(s * n); constraints.max(1)],
            ends: vec![zeros(n); constraints],
            columns_known: false,
            last_defect: T::INFINITY,
            slopes: DenseLu::new(constraints),
            t: DVector::zeros(constraints),
            delta: zeros(s - 1),
        }
    }

    /// Whether they have been taken in this step.
    pub(crate) fn are_known(&self) -> bool {
        self.known
    }

    /// Whether they were taken from more than one α.
    pub(crate) fn are_a_choice(&self) -> bool {
        self.known && self.choice
    }

    /// Before a move: whether the last one did what its columns promised.
    pub(crate) fn judge_columns(&mut self, constraints: &[Constraint<T>]) {
        let defect = worst(constraints, |c| c.predicted.abs() / c.scale);
        if !(defect < self.last_defect / T::int(SLOW)) {
            self.columns_known = false;
        }
        self.last_defect = defect;
    }

    /// Whether the next move has to solve for its columns.
    pub(crate) fn columns_are_due(&self) -> bool {
        !self.columns_known
    }

    pub(crate) fn forget(&mut self) {
        self.known = false;
        self.columns_known = false;
        self.last_defect = T::INFINITY;
    }

    /// Begins to take them at the current stages. Returns whether the local error of the step is of use.
    pub(crate) fn begin(
        &mut self,
        stages: &Stages<T>,
        linearised: &Linearised<T>,
        free: &Range<usize>,
        norm: Norm,
    ) -> bool {
        self.d.iter_mut().for_each(|d| d.fill(T::int(0)));
        self.base.fill(T::int(0));
        self.base_due = false;
        self.known = true;
        self.choice = free.len() > 1;
        self.columns_known = false;
        linearised.resolution(&mut self.resolution);
        stages.sizes(&mut self.sizes);
        let plain = norm == Norm::Plain;
        (self.displacements).begin(&self.sizes, &self.resolution, plain);
        free.len() > 1 && !plain && self.displacements.trusts_error()
    }

    /// Whether there is motion that the step does not resolve, and would not if it were halved so often.
    pub(crate) fn are_of_unresolved_motion(&self, halvings: u32) -> bool {
        self.displacements.is_unresolved(halvings)
    }

    /// How far the α's move slow motion, relative to the state.
    pub(crate) fn slow_displacement(&self, alphas: &[T]) -> T {
        self.displacements.slow(alphas)
    }

    /// max_i |Y_ij|.
    pub(crate) fn sizes(&self) -> &[T] {
        &self.sizes
    }

    /// Only slow displacements are to count.
    pub(crate) fn count_slow_motion(&mut self) {
        self.displacements.count_slow_motion();
    }

    /// Takes the directions at the current stages. `free` holds the numbers k of the free α's; the constraints hold
    /// their gradients at both ends of the step; `error` is the local error at the end and at the start, if it is of use. `again`: the stages
    /// are not those with α = 0, but those that the α's have led to, and α⁰ is taken relative to these.
    ///
    /// Returns whether they were found. Cost: two solves per free α.
    pub(crate) fn take(
        &mut self,
        stages: &Stages<T>,
        linearised: &mut Linearised<T>,
        (free, again): (Range<usize>, bool),
        constraints: &[Constraint<T>],
        error: Option<(&[T], &[T])>,
        mut slow: Option<&mut Slow<T>>,
    ) -> bool {
        if free.len() == 1 {
            self.d[0][free.start - 1] = T::int(1);
            return true;
        }
        for k in free.clone() {
            let column = &mut self.base_column;
            stages.alpha_derivative(k, column.as_mut_slice());
            stages.to_units(column.as_mut_slice());
            if !linearised.solve_column(stages, column) {
                return false;
            }
            linearised.column_end(stages, column, &mut self.u);
            if !linearised.column_start(stages, &self.u, &mut self.back) {
                return false;
            }
            let (u, back) = (&self.u, &self.back);
            let slopes = constraints
                .iter()
                .map(|c| (dot(&c.gradient, u) - dot(&c.start_gradient, back)) / c.scale);
            self.displacements.push(u, back, slopes);
            if let Some(slow) = &mut slow {
                slow.end.apply(&mut self.u);
                slow.start.apply(&mut self.back);
                self.displacements.push_slow(&self.u, &self.back);
            }
            self.displacements.count_one();
        }
        if !self.displacements.factor() {
            return false;
        }
        let first = free.start - 1;
        let moved = if again { &stages.alphas[first..] } else { &[] };
        if let Some((end, start)) = error {
            self.displacements.aim(end, start, moved);
            self.displacements.base(&mut self.base[first..]);
        }
        self.base_due = again || error.is_some();
        for (base, &alpha) in self.base[first..].iter_mut().zip(moved) {
            *base -= alpha;
        }
        for (a, d) in self.d.iter_mut().enumerate() {
            self.displacements.direction(a, &mut d[first..]);
            // Only the ratios matter: t scales with the rest.
            let largest = d.iter().fold(T::int(0), |a, x| a.max(x.abs()));
            if largest > T::int(0) {
                d.iter_mut().for_each(|x| *x /= largest);
            }
        }
        true
    }

    /// Solves for the moves t that bring the predicted defects to zero, shortened so that every |α_k| stays at most
    /// `bound`; adds their part to the `correction` of the stages and moves the α's.
    ///
    /// Cost: one solve per constraint, with simplified Newton only the first time in a step, and one for α⁰.
    pub(crate) fn step(
        &mut self,
        stages: &mut Stages<T>,
        linearised: &mut Linearised<T>,
        constraints: &[Constraint<T>],
        bound: T,
        correction: &mut DVector<T>,
    ) -> Moved {
        if !self.columns_known && !self.solve_columns(stages, linearised) {
            return Moved::NotAtAll;
        }
        for (a, end) in self.ends.iter().enumerate() {
            for (b, c) in constraints.iter().enumerate() {
                self.slopes.matrix_mut()[(b, a)] = dot(&c.gradient, end) / c.scale;
            }
        }
        if self.base_due && !self.solve_base(stages, linearised) {
            return Moved::NotAtAll;
        }
        for (t, c) in self.t.iter_mut().zip(constraints) {
            let by_base = if self.base_due {
                dot(&c.gradient, &self.base_end)
            } else {
                T::int(0)
            };
            *t = -(c.predicted + by_base) / c.scale;
        }
        if self.slopes.factor().is_err() {
            return Moved::NotAtAll;
        }
        self.slopes.solve(&mut self.t);
        if self.base_due {
            self.delta.copy_from_slice(&self.base);
        } else {
            self.delta.fill(T::int(0));
        }
        for (d, &t) in self.d.iter().zip(self.t.iter()) {
            self.delta
                .iter_mut()
                .zip(d)
                .for_each(|(delta, &d)| *delta += t * d);
        }
        let share = self.share_within(&stages.alphas, bound);
        if !share.is_finite() {
            return Moved::NotAtAll;
        }
        for (column, &t) in self.columns.iter().zip(self.t.iter()) {
            correction.axpy(share * t, column, T::int(1));
        }
        if self.base_due {
            correction.axpy(share, &self.base_column, T::int(1));
            self.base_due = false;
        }
        stages.move_alphas(share, &self.delta);
        let far = correction.amax() > T::ratio(1, FAR);
        self.columns_known = linearised.keeps_columns() && !far;
        if share < T::int(1) {
            Moved::ToBound
        } else {
            Moved::Fully
        }
    }

    /// ∂Z/∂t and ∂y1/∂t for each direction. Returns whether they were found.
    fn solve_columns(&mut self, stages: &Stages<T>, linearised: &mut Linearised<T>) -> bool {
        let columns = self.columns.iter_mut().zip(&mut self.ends);
        self.d.iter().zip(columns).all(|(d, (column, end))| {
            stages.alpha_derivative_along(d, column.as_mut_slice());
            stages.to_units(column.as_mut_slice());
            let found = linearised.solve_column(stages, column);
            linearised.column_end(stages, column, end);
            found
        })
    }

    /// ∂Z and ∂y1 of the move by α⁰. Returns whether they were found.
    fn solve_base(&mut self, stages: &Stages<T>, linearised: &mut Linearised<T>) -> bool {
        let (column, end) = (&mut self.base_column, &mut self.base_end);
        stages.alpha_derivative_along(&self.base, column.as_mut_slice());
        stages.to_units(column.as_mut_slice());
        let found = linearised.solve_column(stages, column);
        linearised.column_end(stages, column, end);
        found
    }

    /// The largest share of the move that keeps every |α_k| within `bound`; NaN if the move is not finite.
    fn share_within(&self, alphas: &[T], bound: T) -> T {
        self.delta
            .iter()
            .zip(alphas)
            .fold(T::int(1), |share, (&delta, &alpha)| {
                let room = if delta > T::int(0) {
                    bound - alpha
                } else {
                    bound + alpha
                };
                if !delta.is_finite() {
                    T::NAN
                } else if delta.abs() > room {
                    share.min(room / delta.abs())
                } else {
                    share
                }
            })
    }
}
