//! The α part: which way the free α's move to bring g to zero with the least displacement.
//!
//! One equation (or a few, with further invariants to keep) for up to s − 1 unknowns. With slopes v_k = dg/dα_k and
//! displacements ‖u_k‖ the α's move along
//!
//! $$ \delta\alpha_k = t\, d_k, \qquad d_k = \frac{v_k}{\lVert u_k \rVert^2}, $$
//!
//! the smallest (δα_k ‖u_k‖)_k that changes g as wanted (project note, section 3); t is solved for together with the
//! stages. With r equations there are r directions, the columns of W Vᵀ, W = diag(‖u_k‖⁻²), and r unknowns t.
//! A direction does not change when an α is rescaled, and a vanishing slope costs nothing while another does not vanish.
//!
//! *Symmetry in time.* v_k and ‖u_k‖² are means over the two ends of the step: u_k moves the end with the start held,
//! u'_k = −Ψ⁻¹u_k the start with the end held. The direction is taken once, when the stages with α = 0 have converged,
//! so the step backwards takes the same.
//!
//! *The norm.* Motion that the step resolves counts in full, motion with hω ≫ 1 with 1/(1 + (hω)²): the energy defect of an
//! unresolved oscillation must not be paid for by the slow variables. Measured in `docs/adr/0003-which-displacement.md`.

use crate::constraint::{Constraint, worst};
use crate::linear::DenseLu;
use crate::linearised::Linearised;
use crate::stages::Stages;
use equip_scalar::Float;
use nalgebra::DVector;

/// Columns solved for at stages that have moved by more than 1/1000 since are solved for anew.
const FAR: i64 = 1000;

/// Columns that bring a defect down by less than this are solved for anew.
const SLOW: i64 = 32;

/// Which displacements count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Norm {
    /// Resolved motion in full, unresolved motion with 1/(1 + (hω)²).
    Resolved,
    /// All components alike, relative to their size: the second try where the first needs too large an α.
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
    weights: Vec<T>,
    sizes: Vec<T>,
    u: Vec<T>,
    back: Vec<T>,
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
            weights: zeros(n),
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

    /// Takes the directions at the current stages. `free` holds the numbers k of the free α's; the constraints hold
    /// their gradients at both ends of the step.
    ///
    /// Returns whether they were found. Cost: two solves per free α.
    pub(crate) fn take(
        &mut self,
        stages: &Stages<T>,
        linearised: &mut Linearised<T>,
        free: std::ops::Range<usize>,
        constraints: &[Constraint<T>],
        norm: Norm,
    ) -> bool {
        self.d.iter_mut().for_each(|d| d.fill(T::int(0)));
        self.known = true;
        self.columns_known = false;
        if free.len() == 1 {
            self.d[0][free.start - 1] = T::int(1);
            return true;
        }
        match norm {
            Norm::Resolved => linearised.resolution(stages.n, &mut self.weights),
            Norm::Plain => self.weights.fill(T::int(1)),
        }
        stages.sizes(&mut self.sizes);
        let two = T::int(2);
        for k in free {
            let column = &mut self.columns[0];
            stages.alpha_derivative(k, column.as_mut_slice());
            stages.to_units(column.as_mut_slice());
            if !linearised.solve_column(stages, column) {
                return false;
            }
            linearised.column_end(stages, column, &mut self.u);
            if !linearised.column_start(stages, &self.u, &mut self.back) {
                return false;
            }
            let square = (self.norm_squared(&self.u) + self.norm_squared(&self.back)) / two;
            for (d, c) in self.d.iter_mut().zip(constraints) {
                let change = dot(&c.gradient, &self.u) - dot(&c.start_gradient, &self.back);
                let x = change / c.scale / two / square;
                d[k - 1] = if x.is_finite() { x } else { T::int(0) };
            }
        }
        // Only the ratios matter: t scales with the rest.
        for d in &mut self.d {
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
    /// Cost: one solve per constraint, with simplified Newton only the first time in a step.
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
        for (t, c) in self.t.iter_mut().zip(constraints) {
            *t = -c.predicted / c.scale;
        }
        if self.slopes.factor().is_err() {
            return Moved::NotAtAll;
        }
        self.slopes.solve(&mut self.t);
        self.delta.fill(T::int(0));
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

    fn norm_squared(&self, u: &[T]) -> T {
        let terms = u.iter().zip(&self.sizes).zip(&self.weights);
        terms.fold(T::int(0), |sum, ((&x, &size), &weight)| {
            let x = weight * x / size;
            if x.is_finite() { sum + x * x } else { sum }
        })
    }
}

/// Scalar product.
pub(crate) fn dot<T: Float>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::int(0), |sum, (&x, &y)| sum + x * y)
}
