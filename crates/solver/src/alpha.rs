//! The α part: which way the free α's move to bring g to zero with the least displacement.
//!
//! One equation for up to s − 1 unknowns. With slopes v_k = dg/dα_k and displacements ‖u_k‖ the α's move along
//!
//! $$ \delta\alpha_k = t\, d_k, \qquad d_k = \frac{v_k}{\lVert u_k \rVert^2}, $$
//!
//! the smallest (δα_k ‖u_k‖)_k that changes g as wanted (project note, section 3); t is solved for together with the
//! stages. The direction does not change when an α is rescaled, and a vanishing slope costs nothing while another
//! does not vanish.
//!
//! *Symmetry in time.* v_k and ‖u_k‖² are means over the two ends of the step: u_k moves the end with the start held,
//! u'_k = −Ψ⁻¹u_k the start with the end held. The direction is taken once, when the stages with α = 0 have converged,
//! so the step backwards takes the same.
//!
//! *The norm.* Motion that the step resolves counts in full, motion with hω ≫ 1 with 1/(1 + (hω)²): the energy defect of an
//! unresolved oscillation must not be paid for by the slow variables. Measured in `docs/adr/0004-which-displacement.md`.

use crate::linearisation::Linearisation;
use crate::stages::Stages;
use equip_scalar::Float;
use nalgebra::DVector;

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

/// Direction of the free α's and workspace for it.
#[derive(Debug)]
pub(crate) struct Direction<T: Float> {
    /// d_1 … d_{s−1}; zero where the α is not free.
    pub(crate) d: Vec<T>,
    known: bool,
    weights: Vec<T>,
    sizes: Vec<T>,
    u: Vec<T>,
    back: Vec<T>,
    column: DVector<T>,
}

impl<T: Float> Direction<T> {
    pub(crate) fn new(s: usize, n: usize) -> Self {
        let zeros = |len: usize| vec![T::int(0); len];
        Direction {
            d: zeros(s - 1),
            known: false,
            weights: zeros(n),
            sizes: zeros(n),
            u: zeros(n),
            back: zeros(n),
            column: DVector::zeros(s * n),
        }
    }

    /// Whether it has been taken in this step.
    pub(crate) fn is_known(&self) -> bool {
        self.known
    }

    pub(crate) fn forget(&mut self) {
        self.known = false;
    }

    /// Takes the direction at the current stages. `free` holds the numbers k of the free α's; `start` and `end` are
    /// ∇H at y0 and y1, `energy_scale` the energy that makes them dimensionless.
    ///
    /// Cost: two solves per free α.
    pub(crate) fn take(
        &mut self,
        stages: &Stages<T>,
        linearisation: &mut Linearisation<T>,
        free: std::ops::Range<usize>,
        (start, end, energy_scale): (&[T], &[T], T),
        norm: Norm,
    ) {
        self.d.fill(T::int(0));
        self.known = true;
        if free.len() == 1 {
            self.d[free.start - 1] = T::int(1);
            return;
        }
        match norm {
            Norm::Resolved => linearisation.resolution(stages.n, &mut self.weights),
            Norm::Plain => self.weights.fill(T::int(1)),
        }
        stages.sizes(&mut self.sizes);
        let two = T::int(2);
        let mut largest = T::int(0);
        for k in free {
            stages.alpha_derivative(k, self.column.as_mut_slice());
            stages.to_units(self.column.as_mut_slice());
            linearisation.solve(&mut self.column);
            linearisation.end_displacement(stages, &self.column, &mut self.u);
            linearisation.start_displacement(stages, &self.u, &mut self.back);
            let slope = (dot(end, &self.u) - dot(start, &self.back)) / energy_scale / two;
            let square = (self.norm_squared(&self.u) + self.norm_squared(&self.back)) / two;
            let d = slope / square;
            self.d[k - 1] = if d.is_finite() { d } else { T::int(0) };
            largest = largest.max(self.d[k - 1].abs());
        }
        // Only the ratios matter: t scales with the rest.
        if largest > T::int(0) {
            self.d.iter_mut().for_each(|d| *d /= largest);
        }
    }

    fn norm_squared(&self, u: &[T]) -> T {
        let terms = u.iter().zip(&self.sizes).zip(&self.weights);
        terms.fold(T::int(0), |sum, ((&x, &size), &weight)| {
            let x = weight * x / size;
            if x.is_finite() { sum + x * x } else { sum }
        })
    }

    /// Shortens the move `t` along the direction so that |α_k| stays at most `bound`.
    pub(crate) fn within(&self, t: T, alphas: &[T], bound: T) -> (T, Moved) {
        if !t.is_finite() {
            return (T::int(0), Moved::NotAtAll);
        }
        let mut share = T::int(1);
        for (&d, &alpha) in self.d.iter().zip(alphas) {
            let move_by = t * d;
            let room = if move_by > T::int(0) {
                bound - alpha
            } else {
                bound + alpha
            };
            if move_by.abs() > room {
                share = share.min(room / move_by.abs());
            }
        }
        let moved = if share < T::int(1) {
            Moved::ToBound
        } else {
            Moved::Fully
        };
        (t * share, moved)
    }
}

/// Scalar product.
pub(crate) fn dot<T: Float>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::int(0), |sum, (&x, &y)| sum + x * y)
}
