//! Which α's move the end of a step towards the exact flow, and how they bring the constraints to zero besides.
//!
//! The α's move the end point by U α, U = (u_1 … u_{s−1}), and e is the local error of the step with α = 0
//! ([`crate::local_error`]). Wanted are the α's of
//!
//! $$ \tfrac12 \lVert U\alpha - \varphi e \rVert^2 + \tfrac{r}{2} \sum_k \lVert u_k \rVert^2 \alpha_k^2 \to \min,
//!    \qquad V^T \alpha = -g, $$
//!
//! v_k = dg/dα_k: of all that keep the energy those that leave the least local error. They are
//!
//! $$ \alpha = \alpha^0 + D t, \qquad \alpha^0 = (G + r\,\mathrm{diag}\,G)^{-1} U^T \varphi e, \qquad
//!    D = (G + r\,\mathrm{diag}\,G)^{-1} V, \qquad G = U^T U, $$
//!
//! with t from the constraints. Where φ = 0 this is the least displacement. All u_k are weighted together, not one by one: they
//! are nearly parallel, and a large part of each is along the flow.
//!
//! *Symmetry in time.* Norms and slopes are means over the two ends of the step: u_k moves the end with the start held,
//! u'_k = −Ψ⁻¹u_k the start with the end held; likewise e' = −Ψ⁻¹e.
//!
//! *Norm.* Component j counts in units of its size and with 1/(1 + ρ_j), ρ_j = (hω)² for an oscillator: an unresolved
//! oscillation must not be paid for by the slow variables.
//! *Trust.* φ = 1/(1 + (ρ_max/16)⁴): e means nothing where the step does not resolve the motion; there the ridge r rises from 1/1000 to 3/10.
//!
//! Measured in `docs/adr/0003-which-displacement.md`. Cost: (s−1)² n operations and a factorisation of size s − 1.

use crate::linear::DenseLu;
use equip_scalar::Float;
use nalgebra::DVector;

/// ρ_max at which the local error is half trusted, and beyond which motion counts as not resolved: hω = 4.
pub(crate) const TRUSTED: i64 = 16;

/// The displacements of the free α's, and what is solved with them.
#[derive(Debug)]
pub(crate) struct Displacements<T: Float> {
    n: usize,
    /// Weights of the components.
    weights: Vec<T>,
    /// u_k and u'_k weighted, one after the other: 2 n numbers for each free α.
    rows: Vec<T>,
    /// The slow parts of the same, relative to the sizes of the components.
    slow_rows: Vec<T>,
    units: Vec<T>,
    slow_only: bool,
    /// ρ_max.
    rho: T,
    count: usize,
    /// ‖u_k‖.
    norms: Vec<T>,
    /// v_k of each constraint, one constraint after the other.
    slopes: Vec<T>,
    /// e and e' weighted, times φ.
    target: Vec<T>,
    trust: T,
    ridge: T,
    gram: DenseLu<T>,
    x: DVector<T>,
}

impl<T: Float> Displacements<T> {
    pub(crate) fn new(s: usize, n: usize, constraints: usize) -> Self {
        let zeros = |len: usize| vec![T::int(0); len];
        Displacements {
            n,
            weights: zeros(n),
            rows: zeros((s - 1) * 2 * n),
            slow_rows: zeros((s - 1) * 2 * n),
            units: zeros(n),
            slow_only: false,
            rho: T::int(0),
            count: 0,
            norms: zeros(s - 1),
            slopes: zeros((s - 1) * constraints),
            target: zeros(2 * n),
            trust: T::int(0),
            ridge: T::int(0),
            gram: DenseLu::new(s - 1),
            x: DVector::zeros(s - 1),
        }
    }

    /// Begins with components of these `sizes`, resolved to 1/(1 + ρ_j), which is part of the norm unless `plain`;
    /// that also takes smaller α's for a larger displacement.
    pub(crate) fn begin(&mut self, sizes: &[T], resolution: &[T], plain: bool) {
        let (zero, one) = (T::int(0), T::int(1));
        self.count = 0;
        self.target.fill(zero);
        for (weight, (&size, &resolution)) in
            self.weights.iter_mut().zip(sizes.iter().zip(resolution))
        {
            // A component that does not move has no size and does not count.
            let x = if plain { one } else { resolution } / size;
            *weight = if x.is_finite() { x } else { zero };
        }
        for (unit, &size) in self.units.iter_mut().zip(sizes) {
            let x = one / size;
            *unit = if x.is_finite() { x } else { zero };
        }
        self.slow_only = false;
        self.slow_rows.fill(zero);
        let least = resolution.iter().fold(one, |a, &x| a.min(x));
        let excess = (one / least - one) / T::int(TRUSTED);
        let fourth = excess * excess * excess * excess;
        self.trust = one / (one + fourth);
        self.rho = one / least - one;
        self.ridge = if plain {
            one
        } else {
            T::ratio(1, 1000) + T::ratio(3, 10) * (one - self.trust)
        };
    }

    /// Only slow displacements are to count, which are to be pushed besides the others.
    pub(crate) fn count_slow_motion(&mut self) {
        self.slow_only = true;
        self.trust = T::int(0);
    }

    /// Whether there is motion that the step does not resolve, and would not if it were halved so often.
    pub(crate) fn is_unresolved(&self, halvings: u32) -> bool {
        let quarter = T::ratio(1, 4);
        (0..halvings).fold(self.rho, |rho, _| rho * quarter) > T::int(TRUSTED)
    }

    /// Whether the local error is worth estimating.
    pub(crate) fn trusts_error(&self) -> bool {
        self.trust > T::ratio(1, 1000)
    }

    /// Adds a free α with its displacements of the end and of the start, and its `slopes`, one for each constraint.
    pub(crate) fn push(&mut self, end: &[T], start: &[T], slopes: impl Iterator<Item = T>) {
        let (k, n, places) = (self.count, self.n, self.norms.len());
        let row = &mut self.rows[k * 2 * n..][..2 * n];
        weigh(&self.weights, end, &mut row[..n]);
        weigh(&self.weights, start, &mut row[n..]);
        self.norms[k] = dot(row, row).sqrt();
        for (a, slope) in slopes.enumerate() {
            self.slopes[a * places + k] = slope;
        }
    }

    /// Adds the slow parts of the displacements that were pushed last.
    pub(crate) fn push_slow(&mut self, end: &[T], start: &[T]) {
        let (k, n) = (self.count, self.n);
        let row = &mut self.slow_rows[k * 2 * n..][..2 * n];
        weigh(&self.units, end, &mut row[..n]);
        weigh(&self.units, start, &mut row[n..]);
        if self.slow_only {
            self.norms[k] = dot(row, row).sqrt();
            self.rows[k * 2 * n..][..2 * n].copy_from_slice(row);
        }
    }

    /// The free α is complete.
    pub(crate) fn count_one(&mut self) {
        self.count += 1;
    }

    /// How far these `alphas` move slow motion, at both ends of the step.
    pub(crate) fn slow(&self, alphas: &[T]) -> T {
        let n = 2 * self.n;
        let component = |j: usize| {
            let column = self.slow_rows[j..].iter().step_by(n);
            let sum = alphas.iter().zip(column);
            sum.fold(T::int(0), |sum, (&alpha, &u)| sum + alpha * u)
        };
        let squares = (0..n).map(component);
        squares.fold(T::int(0), |sum, x| sum + x * x).sqrt()
    }

    /// Sets the local error at the end and at the start of the step as the displacement that is aimed at; besides what these
    /// `alphas`, if there are any, have moved already.
    pub(crate) fn aim(&mut self, end: &[T], start: &[T], alphas: &[T]) {
        let n = self.n;
        weigh(&self.weights, end, &mut self.target[..n]);
        weigh(&self.weights, start, &mut self.target[n..]);
        for (&alpha, row) in alphas.iter().zip(self.rows.chunks_exact(2 * n)) {
            let target = self.target.iter_mut().zip(row);
            target.for_each(|(x, &u)| *x += alpha * u);
        }
        let trust = self.trust;
        self.target.iter_mut().for_each(|x| *x *= trust);
    }

    /// Factorises G + r diag G, rows and columns in units of ‖u_k‖. Returns whether that was possible.
    pub(crate) fn factor(&mut self) -> bool {
        let diagonal = T::int(1) + self.ridge;
        let (places, n) = (self.norms.len(), 2 * self.n);
        let matrix = self.gram.matrix_mut();
        matrix.fill_with_identity();
        for k in 0..self.count.min(places) {
            matrix[(k, k)] = diagonal;
            for l in 0..k {
                let product = dot(&self.rows[k * n..][..n], &self.rows[l * n..][..n]);
                let x = product / self.norms[k] / self.norms[l];
                let x = if x.is_finite() { x } else { T::int(0) };
                matrix[(k, l)] = x;
                matrix[(l, k)] = x;
            }
        }
        self.gram.factor().is_ok()
    }

    /// α⁰ into `alphas`, one number for each α that was pushed.
    pub(crate) fn base(&mut self, alphas: &mut [T]) {
        let n = 2 * self.n;
        self.x.fill(T::int(0));
        for k in 0..self.count {
            self.x[k] = dot(&self.rows[k * n..][..n], &self.target);
        }
        self.solve(alphas);
    }

    /// The column of D for one constraint into `alphas`.
    pub(crate) fn direction(&mut self, constraint: usize, alphas: &mut [T]) {
        let places = self.norms.len();
        self.x.fill(T::int(0));
        for k in 0..self.count {
            self.x[k] = self.slopes[constraint * places + k];
        }
        self.solve(alphas);
    }

    fn solve(&mut self, alphas: &mut [T]) {
        let finite = |x: T| if x.is_finite() { x } else { T::int(0) };
        for (x, &norm) in self.x.iter_mut().zip(&self.norms[..self.count]) {
            *x = finite(*x / norm);
        }
        self.gram.solve(&mut self.x);
        for (alpha, (&x, &norm)) in alphas.iter_mut().zip(self.x.iter().zip(&self.norms)) {
            *alpha = finite(x / norm);
        }
    }
}

fn weigh<T: Float>(weights: &[T], x: &[T], out: &mut [T]) {
    for (out, (&weight, &x)) in out.iter_mut().zip(weights.iter().zip(x)) {
        *out = weight * x;
    }
}

/// Scalar product.
pub(crate) fn dot<T: Float>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::int(0), |sum, (&x, &y)| sum + x * y)
}
